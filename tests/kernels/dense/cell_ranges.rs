//! The ranges of cells.

use hsad::{
    disparity::{DisparityRange, NONE, SCALE},
    image::{Plane, Size},
    verify::{Values, trials::CellRangesTrial},
};

use crate::common::*;

#[test]
fn the_twin_finds_the_same_ranges() {
    for (min, count) in [(0, 64), (-9, 33), (5, 1), (-3000, 6001)] {
        let range = DisparityRange::new(min, count).unwrap();
        for Size { width, height } in SIZES {
            let half = (width.div_ceil(2), height.div_ceil(2));
            let (steps, holes) = (picture((half.0, half.1), 81), picture((half.0, half.1), 82));
            let map = Plane::from_fn(half, |x, y| {
                let share = i64::from(steps.get(x, y)) * i64::from(count) * i64::from(SCALE) / 512;
                // Holes become denser to the right.
                let hole = u32::from(holes.get(x, y)) < x * 300 / half.0;
                if hole { NONE } else { min * SCALE / 2 + share as i32 }
            });
            let what = format!("{width}x{height}, {count} from {min}");
            assert_twin(&what, &CellRangesTrial { size: Size::new(width, height), map, range });
        }
    }
}

#[test]
fn a_cell_by_hand() {
    // One cell, 8x8 pixels at half size: four blocks of 4x4.
    let range = DisparityRange::new(0, 64).unwrap();
    let found = |map: Vec<i32>| {
        let map = Plane::new((8, 8), map).unwrap();
        leaves(&CellRangesTrial { size: Size::new(16, 16), map, range }).remove(0)
    };
    let range = |first: u32, count: u32| Values::from(vec![first, count]);
    let mut map = vec![10 * SCALE; 64];
    // 2 x 10 - 2 to 2 x 10 + 2.
    assert_eq!(found(map.clone()), range(18, 5));
    // Two outliers in a block have no effect, in however many blocks; three have. Halves go up.
    for i in [0, 1, 4, 5] {
        map[i] = 4 * SCALE;
    }
    map[54] = 21 * SCALE;
    map[63] = 20 * SCALE - SCALE / 2;
    assert_eq!(found(map.clone()), range(18, 5));
    map[6] = 5 * SCALE;
    assert_eq!(found(map.clone()), range(8, 15));
    map[62] = 22 * SCALE;
    assert_eq!(found(map), range(8, 35));
    // 7 of 64 pixels are at least 10 %; three of them must lie in one block.
    let mut thin = vec![NONE; 64];
    thin[..7].fill(10 * SCALE);
    assert_eq!(found(thin.clone()), range(18, 5));
    thin[0] = NONE;
    assert_eq!(found(thin), range(0, 64));
    let mut scattered = vec![NONE; 64];
    for i in [0, 1, 4, 5, 32, 33, 36] {
        scattered[i] = 10 * SCALE;
    }
    assert_eq!(found(scattered), range(0, 64));
}
