//! Selection among the disparities of cells.

use hsad::{
    dense::Interpolation,
    disparity::{DisparityRange, NONE, SCALE},
    image::{Plane, Size},
    internals::{
        cpu::dense::CellVolume,
        dense::{CellRange, CellTable},
    },
    verify::trials::CellSelectTrial,
};

use super::levels::{LARGE, table, volume};
use crate::common::*;

#[test]
fn the_twin_selects_the_same() {
    for size in SIZES.into_iter().chain(LARGE) {
        for (count, stored, uniqueness) in [(1_u32, 3, 0), (17, 1, 0), (40, 4, 10), (70, 8, 1)] {
            for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
                let table = table(size, count);
                let paths = (0..stored).map(|seed| volume(&table, seed, 255)).collect();
                let what = format!("{size}, {count} disparities, {stored} paths, {interpolation:?}");
                assert_twin(&what, &CellSelectTrial { paths, interpolation, uniqueness });
            }
        }
    }
}

/// Disparity, confidence and key of one pixel with disparities `first` to `first` + 15 of -2 to 37.
fn selected(first: u32, costs: [u8; 16]) -> (i32, u32, u32) {
    let range = DisparityRange::new(-2, 40).unwrap();
    let cells = Plane::filled((1, 1), CellRange { first: first / 4, words: 4 });
    let table = CellTable { size: Size::new(1, 1), range, cells, above: 0 };
    let paths = vec![CellVolume { table: table.clone(), values: costs.to_vec() }; 2];
    let found = leaves(&CellSelectTrial { paths, interpolation: Interpolation::Parabola, uniqueness: 0 });
    match &found[..] {
        [hsad::verify::Values::I32(d), hsad::verify::Values::U32(c), hsad::verify::Values::U32(k)] => {
            (d[0], c[0], k[0])
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn by_hand() {
    let mut costs = [40; 16];
    // Sums 40 at the winner, 60 and 80 beside: (60 - 40 - (80 - 40)) / 2 (20 + 40) = -1/6 px. The rival's sum is 70.
    (costs[4], costs[5], costs[6], costs[9]) = (30, 20, 40, 35);
    let key = 40 << 16 | 13;
    assert_eq!(selected(8, costs), ((13 - 2) * SCALE - 43, 1 + 254 * 30 / 70, key));
    // At an end of the cell, which is none of the whole range.
    let mut costs = [40; 16];
    costs[0] = 1;
    assert_eq!(selected(8, costs), (NONE, 0, u32::MAX));
    assert_eq!(selected(0, costs).0, -2 * SCALE);
    costs.reverse();
    assert_eq!(selected(8, costs), (NONE, 0, u32::MAX));
    // The whole range ends at number 39: of 32 to 47 the last eight are none, and of the others the first is the winner.
    assert_eq!(selected(32, costs).0, NONE);
    let mut costs = [40; 16];
    costs[7] = 1;
    assert_eq!(selected(32, costs).0, 37 * SCALE);
}
