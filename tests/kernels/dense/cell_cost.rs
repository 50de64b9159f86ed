//! The matching cost at the disparities of cells.

use hsad::{
    dense::{Cost, Difference, View},
    disparity::DisparityRange,
    image::{Plane, Size},
    internals::{
        cpu::dense::Transforms,
        dense::{CellRange, CellTable, PIXELS_HARDWARE, PIXELS_SOFTWARE},
    },
    verify::trials::{CellCostTrial, CostKernel, CostTrial},
};

use super::levels::{LARGE, table};
use crate::common::*;

const COST: Cost = Cost {
    census: 40,
    difference: Difference { weight: 16, limit: 24 },
    gradient: Difference { weight: 8, limit: 40 },
    weak_spread: Some(200),
};

#[test]
fn the_twin_costs_the_same() {
    for size in SIZES.into_iter().chain(LARGE) {
        for view in [View::Left, View::Right] {
            let views = [1, 2].map(|seed| Transforms::new(&picture(size, seed), &COST));
            for pixels in [PIXELS_SOFTWARE, PIXELS_HARDWARE] {
                let (views, table) = (views.clone(), table(size, 70));
                let trial = CellCostTrial { views, view, cost: COST, table, band_rows: 23, pixels };
                assert_twin(&format!("{size} {view:?}, {pixels} pixels per thread"), &trial);
            }
        }
    }
}

#[test]
fn a_cell_has_its_part_of_the_whole_costs() {
    let size = Size::new(40, 3);
    let views = [1, 2].map(|seed| Transforms::new(&picture(size, seed), &COST));
    let range = DisparityRange::new(-5, 48).unwrap();
    let whole =
        CostTrial { views: views.clone(), view: View::Left, cost: COST, range, rows: 0..3, by: CostKernel::Lanes };
    let ranges = [CellRange { first: 2, words: 4 }, CellRange { first: 0, words: 8 }];
    let table = CellTable { size, range, cells: Plane::new((2, 1), ranges.to_vec()).unwrap(), above: 0 };
    let of_cells = CellCostTrial { views, view: View::Left, cost: COST, table, band_rows: 3, pixels: PIXELS_HARDWARE };
    let (all, part) = (values(&whole), values(&of_cells));
    // 48 values per pixel; the first cell has 32 pixels with numbers 8 to 23, the second 8 with 0 to 31.
    let row = 32 * 16 + 8 * 32;
    assert_eq!(part[row + 16..row + 32], all[40 * 48 + 48 + 8..][..16]);
    assert_eq!(part[row + 32 * 16 + 32..][..32], all[40 * 48 + 33 * 48..][..32]);
}

fn values(trial: &dyn hsad::verify::Trial) -> Vec<u8> {
    match leaves(trial).remove(0) {
        hsad::verify::Values::U8(values) => values,
        other => panic!("{other:?}"),
    }
}
