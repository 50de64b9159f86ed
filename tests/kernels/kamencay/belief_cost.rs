//! The data cost of belief propagation.

use hsad::{
    dense::{Brightness, Difference},
    disparity::DisparityRange,
    image::{Plane, Size},
    internals::kamencay::{Strip, described},
    kamencay::WindowCost,
    verify::{Values, trials::BeliefCostTrial},
};

use crate::{common::*, kamencay::compute::colours};

const COST: WindowCost = WindowCost {
    radius: 1,
    color: Difference { weight: 16, limit: 20 },
    gradient: Difference { weight: 24, limit: 16 },
};

fn compare(Size { width, height }: Size, cost: WindowCost, (min, count): (i32, u32)) {
    let range = DisparityRange::new(min, count).unwrap();
    let views = [1, 2].map(|seed| described(&colours((width, height), seed), Brightness::SAME));
    let whole = Strip { first_row: 0, rows: height };
    let inner = (height > 2).then(|| Strip { first_row: 1, rows: height - 2 });
    for strip in [whole].into_iter().chain(inner) {
        let what = format!("{width}x{height} {strip:?} {cost:?} {count} from {min}");
        assert_twin(&what, &BeliefCostTrial { views: views.clone(), strip, cost, range });
    }
}

#[test]
fn the_twin_costs_the_same() {
    for size in SIZES {
        compare(size, COST, (0, 17));
    }
    for range in [(0, 1), (-20, 41), (5, 3), (-500, 12), (90, 100)] {
        compare(Size::new(97, 5), COST, range);
    }
    let none = Difference { weight: 0, limit: 0 };
    let most = Difference { weight: 4096, limit: 255 };
    for cost in [
        WindowCost { radius: 0, ..COST },
        WindowCost { radius: 3, gradient: none, ..COST },
        WindowCost { radius: 7, color: most, gradient: most },
    ] {
        compare(Size::new(33, 9), cost, (-3, 10));
    }
}

#[test]
fn by_hand() {
    let words = |pixels: [[u8; 4]; 3]| Plane::new((3, 1), pixels.map(u32::from_le_bytes).to_vec()).unwrap();
    let left = words([[0, 0, 0, 128], [50, 60, 70, 140], [0, 0, 0, 128]]);
    let right = words([[50, 60, 70, 140], [53, 60, 61, 150], [250, 60, 70, 140]]);
    let range = DisparityRange::new(-1, 3).unwrap();
    let strip = Strip { first_row: 0, rows: 1 };
    let cost = WindowCost { radius: 0, ..COST };
    // Pixel 1 at disparity -1: channels differ by 200, 0 and 0, truncated to 60: 16 * 60 / 48 = 20. At 0: by 3, 0 and
    // 9, the gradient by 10: (16 * 12 + 3 * 24 * 10) / 48 = 19. At 1 the pixels are equal; the last cost is padding.
    let Values::U32(costs) = leaves(&BeliefCostTrial { views: [left, right], strip, cost, range }).remove(0) else {
        panic!("costs are words");
    };
    assert_eq!(costs[4..8], [20, 19, 0, 0xffff]);
}
