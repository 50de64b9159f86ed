//! A path of semi-global matching through cells.

use hsad::{
    dense::Penalties,
    disparity::DisparityRange,
    image::{Plane, Size},
    internals::{
        cpu::dense::CellVolume,
        dense::{CellRange, CellTable, Direction},
    },
    verify::trials::{CellPathTrial, PathTrial},
};

use super::levels::{LARGE, table, volume};
use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };

fn trial(size: Size, direction: Direction, band_rows: u32) -> CellPathTrial {
    let reference = picture(size, 71).map(|&value| u32::from(value) | 0xabcd_ef00);
    CellPathTrial { reference, costs: volume(&table(size, 70), 77, 127), direction, penalties: PENALTIES, band_rows }
}

#[test]
fn the_twin_goes_the_same_way() {
    for size in SIZES.into_iter().chain(LARGE) {
        for direction in Direction::ALL {
            assert_twin(&format!("{size} {direction:?}"), &trial(size, direction, size.height));
        }
    }
}

#[test]
fn bands_leave_no_trace() {
    for direction in Direction::ALL {
        for band_rows in [1, 7, 33] {
            let what = format!("{direction:?} in bands of {band_rows}");
            assert_twin(&what, &trial(Size::new(97, 70), direction, band_rows));
        }
    }
}

#[test]
fn a_line_takes_more_turns_than_lavapipe_counts() {
    for (dx, dy) in [(-1, 0), (1, 0), (0, 1), (1, -1)] {
        let direction = Direction { dx, dy };
        let size = if dy == 0 { Size::new(4000, 1) } else { Size::new(3, 4000) };
        let table = table(size, 576);
        let vectors: u32 = (0..4000).map(|i| table.at(i.min(size.width - 1), i.min(size.height - 1)).words / 4).sum();
        assert!(vectors > 1 << 16, "{vectors}");
        let long = CellPathTrial { costs: volume(&table, 77, 127), ..trial(size, direction, size.height) };
        assert_twin(&format!("{direction:?}"), &long);
    }
}

#[test]
fn with_one_range_a_path_is_that_of_the_whole_range() {
    let size = Size::new(40, 35);
    let table = CellTable::whole(size, DisparityRange::new(0, 16).unwrap());
    for direction in Direction::ALL {
        let of_cells = CellPathTrial { costs: volume(&table, 77, 127), ..trial(size, direction, 35) };
        let (reference, costs) = (of_cells.reference.clone(), of_cells.costs.values.clone());
        let whole = PathTrial { reference, costs, direction, penalties: PENALTIES, band_rows: 35 };
        assert_eq!(leaves(&of_cells), leaves(&whole), "{direction:?}");
    }
}

#[test]
fn a_border_of_cells_by_hand() {
    // Disparities 0 to 15 left of column 32, then 4 to 19. Costs of 10 stay 10 along a line of one luma; the last pixel
    // before the border has 5 at disparity 15.
    let ranges = [CellRange { first: 0, words: 4 }, CellRange { first: 1, words: 4 }];
    let size = Size::new(33, 1);
    let range = DisparityRange::new(0, 20).unwrap();
    let table = CellTable { size, range, cells: Plane::new((2, 1), ranges.to_vec()).unwrap(), above: 0 };
    let mut values = vec![10_u8; 32 * 16];
    values[31 * 16 + 15] = 5;
    values.extend([1; 16]);
    let costs = CellVolume { table, values };
    let direction = Direction { dx: 1, dy: 0 };
    let reference = Plane::filled((33, 1), 7);
    let trial = CellPathTrial { reference, costs, direction, penalties: PENALTIES, band_rows: 1 };
    let hsad::verify::Values::U8(path) = leaves(&trial).remove(0) else { panic!("costs") };
    assert_eq!(path[31 * 16..][..16], [[10; 15].as_slice(), &[5]].concat());
    // No change, 10 - 5 more, or nothing at 15; from 15 to 16 by P1; a jump to 17 and more, where the pixel before has no
    // neighbour.
    let expected = [[1 + 5; 11].as_slice(), &[1, 1 + 16, 1 + 120, 1 + 120, 1 + 120]].concat();
    assert_eq!(path[32 * 16..], expected);
}
