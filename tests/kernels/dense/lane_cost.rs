//! The matching cost with threads across disparities; against the twin in `cost.rs`, beside the other kernel.

use hsad::{
    dense::{Cost, Difference, View},
    disparity::DisparityRange,
    image::Plane,
    internals::cpu::dense::Transforms,
    verify::{
        Values,
        trials::{CostKernel, CostTrial},
    },
};

use crate::common::*;

#[test]
fn by_hand() {
    // The last pixel at its third disparity, whose partner is the first pixel of the row: two bits differ, the luma by 30
    // and its gradient, -40 and 20, by 60, truncated to 40: (40 * 2 + 16 * 24 + 8 * 40) / 16.
    let cost = Cost {
        census: 40,
        difference: Difference { weight: 16, limit: 24 },
        gradient: Difference { weight: 8, limit: 40 },
        weak_spread: None,
    };
    let a = Plane::new((3, 1), vec![50, 100, 0b11 << 8 | 60]).unwrap();
    let b = Plane::new((3, 1), vec![30, 50, 70]).unwrap();
    let views = [a, b].map(|census| Transforms { census, wide: None });
    let range = DisparityRange::new(0, 3).unwrap();
    let trial = CostTrial { views, view: View::Left, cost, range, rows: 0..1, by: CostKernel::Lanes };
    let [Values::U8(costs)] = &leaves(&trial)[..] else { panic!("costs") };
    assert_eq!(costs[2 * 16 + 2], 49);
}
