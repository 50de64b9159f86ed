//! What is searched in each cell.

use hsad::{
    disparity::{DisparityRange, NONE, SCALE},
    image::Plane,
    verify::{Values, cells::CellRangesTrial},
};

use crate::common::*;

#[test]
fn the_twin_finds_the_same_ranges() {
    // The last has more disparities than there are bins.
    for (min, count) in [(0, 64), (-9, 33), (5, 1), (-3000, 6001)] {
        let range = DisparityRange::new(min, count).unwrap();
        for (width, height) in SIZES {
            let half = (width.div_ceil(2), height.div_ceil(2));
            let (steps, holes) = (picture(half.0, half.1, 81), picture(half.0, half.1, 82));
            let map = Plane::from_fn(half.0, half.1, |x, y| {
                let share = i64::from(steps.get(x, y)) * i64::from(count) * i64::from(SCALE) / 512;
                // More and more holes to the right.
                let hole = u32::from(holes.get(x, y)) < x * 300 / half.0;
                if hole { NONE } else { min * SCALE / 2 + share as i32 }
            });
            let what = format!("{width}x{height}, {count} from {min}");
            assert_twin(&what, &CellRangesTrial { size: (width, height), map, range });
        }
    }
}

#[test]
fn a_cell_by_hand() {
    // One cell, of 16x16 pixels at half the size: 3 % of 256 are 7.
    let range = DisparityRange::new(0, 64).unwrap();
    let found = |map: Vec<i32>| {
        let map = Plane::new(16, 16, map).unwrap();
        leaves(&CellRangesTrial { size: (32, 32), map, range }).remove(0)
    };
    let map = |low: usize, high: usize| {
        let mut map = vec![10 * SCALE; 256];
        map[..low].fill(4 * SCALE);
        map[256 - high..].fill(20 * SCALE - SCALE / 2);
        map
    };
    let range = |first: u32, count: u32| Values::from(vec![first, count]);
    // Halves go up. 2 x 10 - 3 to 2 x 10 + 3, if no more than seven are off.
    assert_eq!(found(map(7, 7)), range(17, 7));
    assert_eq!(found(map(8, 7)), range(5, 19));
    assert_eq!(found(map(7, 8)), range(17, 27));
    // Of 256, 26 are 10 %.
    let mut thin = map(0, 0);
    thin[26..].fill(NONE);
    assert_eq!(found(thin.clone()), range(17, 7));
    thin[25] = NONE;
    assert_eq!(found(thin), range(0, 64));
}
