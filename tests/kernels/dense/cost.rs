//! The matching cost.

use hsad::{
    dense::{Cost, Difference, View},
    disparity::DisparityRange,
    image::{Plane, Size},
    internals::cpu::dense::census,
    verify::{Values, trials::CostTrial},
};

use crate::common::*;

const COST: Cost = Cost {
    census: 40,
    difference: Difference { weight: 16, limit: 24 },
    gradient: Difference { weight: 8, limit: 40 },
};

fn compare(Size { width, height }: Size, view: View, cost: &Cost, (min, count): (i32, u32)) {
    let range = DisparityRange::new(min, count).unwrap();
    let views = [1, 2].map(|seed| census(&picture((width, height), seed)));
    let what = format!("{width}x{height} {view:?} {count} from {min}");
    let whole = CostTrial { views, view, cost: *cost, range, rows: 0..height };
    assert_twin(&what, &whole);
    if height > 2 {
        assert_twin(&what, &CostTrial { rows: 1..height - 1, ..whole });
    }
}

#[test]
fn the_twin_costs_the_same() {
    for size in SIZES {
        for view in [View::Left, View::Right] {
            compare(size, view, &COST, (0, 17));
        }
    }
    for range in [(0, 1), (-20, 41), (5, 3), (-500, 12), (90, 100)] {
        for view in [View::Left, View::Right] {
            compare(Size::new(97, 5), view, &COST, range);
        }
    }
    let none = Difference { weight: 0, limit: 0 };
    for cost in [Cost { census: 255, ..COST }, Cost { difference: none, gradient: none, ..COST }] {
        compare(Size::new(97, 5), View::Left, &cost, (0, 17));
    }
}

#[test]
fn by_hand() {
    // Three bits differ, the luma by 30 and its gradient by 10: (40 * 3 + 16 * 24 + 8 * 10) / 16 = 36.5.
    let a = Plane::new((3, 1), vec![50, 0b111 << 8 | 100, 60]).unwrap();
    let b = Plane::new((3, 1), vec![50, 70, 70]).unwrap();
    let range = DisparityRange::new(0, 1).unwrap();
    let trial = CostTrial { views: [a, b], view: View::Left, cost: COST, range, rows: 0..1 };
    let [Values::U8(costs)] = &leaves(&trial)[..] else { panic!("four costs a word") };
    assert_eq!(costs[4], 36);
}
