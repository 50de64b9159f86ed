//! The matching cost.

use hsad::{
    dense::{Cost, Difference, View},
    disparity::DisparityRange,
    image::{Plane, Size},
    internals::{
        cpu::dense::Transforms,
        dense::{PIXELS_HARDWARE, PIXELS_SOFTWARE},
    },
    verify::{
        Values,
        trials::{CostKernel, CostTrial},
    },
};

use crate::common::*;

const COST: Cost = Cost {
    census: 40,
    difference: Difference { weight: 16, limit: 24 },
    gradient: Difference { weight: 8, limit: 40 },
    weak_spread: None,
};
const WEAK: Cost = Cost { weak_spread: Some(300), ..COST };

fn compare(Size { width, height }: Size, view: View, cost: &Cost, (min, count): (i32, u32)) {
    let range = DisparityRange::new(min, count).unwrap();
    let views = [1, 2].map(|seed| Transforms::new(&picture((width, height), seed), cost));
    let what = format!("{width}x{height} {view:?} {cost:?} {count} from {min}");
    for by in [CostKernel::Pixels(PIXELS_SOFTWARE), CostKernel::Pixels(PIXELS_HARDWARE), CostKernel::Lanes] {
        let whole = CostTrial { views: views.clone(), view, cost: *cost, range, rows: 0..height, by };
        assert_twin(&format!("{what} by {by:?}"), &whole);
        if height > 2 {
            assert_twin(&format!("{what} by {by:?}, some rows"), &CostTrial { rows: 1..height - 1, ..whole });
        }
    }
}

#[test]
fn the_twin_costs_the_same() {
    for size in SIZES {
        for view in [View::Left, View::Right] {
            compare(size, view, &COST, (0, 17));
            compare(size, view, &WEAK, (0, 17));
        }
    }
    for range in [(0, 1), (-20, 41), (5, 3), (-500, 12), (90, 100)] {
        for view in [View::Left, View::Right] {
            compare(Size::new(97, 5), view, &COST, range);
            compare(Size::new(97, 5), view, &WEAK, range);
        }
    }
    let none = Difference { weight: 0, limit: 0 };
    for cost in [
        Cost { census: 255, ..COST },
        Cost { difference: none, gradient: none, ..COST },
        Cost { weak_spread: Some(2295), ..COST },
    ] {
        compare(Size::new(97, 5), View::Left, &cost, (0, 17));
    }
}

#[test]
fn by_hand() {
    // Three bits differ, the luma by 30 and its gradient by 10: (40 * 3 + 16 * 24 + 8 * 10) / 16 = 36.5.
    let a = Plane::new((3, 1), vec![50, 0b111 << 8 | 100, 60]).unwrap();
    let b = Plane::new((3, 1), vec![50, 70, 70]).unwrap();
    let range = DisparityRange::new(0, 1).unwrap();
    let views = [a, b].map(|census| Transforms { census, wide: None });
    let trial =
        CostTrial { views, view: View::Left, cost: COST, range, rows: 0..1, by: CostKernel::Pixels(PIXELS_SOFTWARE) };
    let [Values::U8(costs)] = &leaves(&trial)[..] else { panic!("costs") };
    assert_eq!(costs[16], 36);
}

#[test]
fn of_weak_texture_by_hand() {
    // As above, with five bits of the wide census that differ. The last pixel of the reference is not weak: what the other
    // view says does not count.
    let wide_a = Plane::new((3, 1), vec![1, 0b11111 << 8 | 1, 0b11111 << 8]).unwrap();
    let wide_b = Plane::new((3, 1), vec![1, 0, 1]).unwrap();
    let a = Plane::new((3, 1), vec![50, 0b111 << 8 | 100, 60]).unwrap();
    let b = Plane::new((3, 1), vec![50, 70, 70]).unwrap();
    let views = [(a, wide_a), (b, wide_b)].map(|(census, wide)| Transforms { census, wide: Some(wide) });
    let range = DisparityRange::new(0, 1).unwrap();
    let [Values::U8(costs)] = &leaves(&CostTrial {
        views,
        view: View::Left,
        cost: WEAK,
        range,
        rows: 0..1,
        by: CostKernel::Pixels(PIXELS_SOFTWARE),
    })[..] else {
        panic!("costs")
    };
    // Weak: (40 * 5 + 8 * 10) / 16 = 17.5. Not weak: luma by 10, gradients -40 and 0: (16 * 10 + 8 * 40) / 16.
    assert_eq!((costs[16], costs[32]), (17, 30));
}
