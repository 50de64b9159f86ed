//! What is searched in each cell, of either view.

use hsad::{
    dense::{CellBand, CellRanges, PartnerRanges, View},
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::Plane,
    reference::{CellPlane, cell_ranges, partner_ranges},
};

use crate::common::*;

fn words(cells: &CellPlane) -> Vec<u32> {
    cells.data().iter().flat_map(|&(first, count)| [first, count]).collect()
}

/// The ranges of the cells of a picture of `size`, whose map of half the size is given as a whole.
fn on_device(map: &DisparityMap, size: (u32, u32), range: DisparityRange) -> Vec<u32> {
    let device = &gpu().device;
    let band = CellBand::new(size, (0, size.1), range);
    assert_eq!((band.map_width, band.map_rows), map.size());
    let out = upload(&vec![0_u32; band.words() as usize]);
    poison(&out);
    let dispatch = CellRanges::new(device).prepare(device, &band, &upload(map.data()), &out);
    run(|encoder| dispatch.record(encoder));
    download(&out)
}

fn partners_on_device(cells: &CellPlane, view: View, range: DisparityRange) -> Vec<u32> {
    let device = &gpu().device;
    let band = CellBand::new((32 * cells.width(), 32 * cells.height()), (0, 32 * cells.height()), range);
    let out = upload(&vec![0_u32; band.words() as usize]);
    poison(&out);
    let dispatch = PartnerRanges::new(device).prepare(device, &band, view, &upload(&words(cells)), &out);
    run(|encoder| dispatch.record(encoder));
    download(&out)
}

#[test]
fn the_twin_finds_the_same_ranges() {
    // The last has more disparities than there are bins.
    for (min, count) in [(0, 64), (-9, 33), (5, 1), (-3000, 6001)] {
        let range = DisparityRange::new(min, count).unwrap();
        for (width, height) in SIZES {
            let size = (width.div_ceil(2), height.div_ceil(2));
            let (steps, holes) = (picture(size.0, size.1, 81), picture(size.0, size.1, 82));
            let map = Plane::from_fn(size.0, size.1, |x, y| {
                let share = i64::from(steps.get(x, y)) * i64::from(count) * i64::from(SCALE) / 512;
                // More and more holes to the right.
                if u32::from(holes.get(x, y)) < x * 300 / size.0 { NONE } else { min * SCALE / 2 + share as i32 }
            });
            let expected = cell_ranges(&map, (width, height), range);
            let what = format!("{width}x{height}, {count} from {min}");
            assert_same(&what, &on_device(&map, (width, height), range), &words(&expected));
        }
    }
}

#[test]
fn a_cell_by_hand() {
    // One cell, of 16x16 pixels at half the size: 3 % of 256 are 7.
    let range = DisparityRange::new(0, 64).unwrap();
    let map = |low: usize, high: usize| {
        let mut map = vec![10 * SCALE; 256];
        map[..low].fill(4 * SCALE);
        map[256 - high..].fill(20 * SCALE - SCALE / 2);
        Plane::new(16, 16, map).unwrap()
    };
    // Halves go up. 2 x 10 - 3 to 2 x 10 + 3, if no more than seven are off.
    assert_eq!(on_device(&map(7, 7), (32, 32), range), [17, 7]);
    assert_eq!(on_device(&map(8, 7), (32, 32), range), [5, 19]);
    assert_eq!(on_device(&map(7, 8), (32, 32), range), [17, 27]);
    // Of 256, 26 are 10 %.
    let mut thin = map(0, 0).data().to_vec();
    thin[26..].fill(NONE);
    assert_eq!(on_device(&Plane::new(16, 16, thin.clone()).unwrap(), (32, 32), range), [17, 7]);
    thin[25] = NONE;
    assert_eq!(on_device(&Plane::new(16, 16, thin).unwrap(), (32, 32), range), [0, 64]);
}

#[test]
fn the_twin_finds_the_same_ranges_of_the_other_view() {
    for (min, count) in [(0, 64), (-70, 150), (5, 1)] {
        let range = DisparityRange::new(min, count).unwrap();
        for (columns, rows) in [(1, 1), (9, 3), (70, 2)] {
            let (firsts, counts) = (picture(columns, rows, 91), picture(columns, rows, 92));
            let cells = Plane::from_fn(columns, rows, |x, y| {
                let first = u32::from(firsts.get(x, y)) % count;
                (first, u32::from(counts.get(x, y)) % (count - first + 1))
            });
            for view in [View::Left, View::Right] {
                let what = format!("{columns}x{rows} {view:?}, {count} from {min}");
                let expected = partner_ranges(&cells, view, range);
                assert_same(&what, &partners_on_device(&cells, view, range), &words(&expected));
            }
        }
    }
}

#[test]
fn partners_by_hand() {
    // The second of three cells, pixels 32 to 63 with disparities 10 to 40: from any of these to the first cell of the
    // right view, with 10 to 31 to the second.
    let range = DisparityRange::new(0, 50).unwrap();
    let cells = Plane::new(3, 1, vec![(0, 0), (10, 31), (0, 0)]).unwrap();
    assert_eq!(partners_on_device(&cells, View::Left, range), [10, 31, 10, 22, 0, 0]);
    assert_eq!(partners_on_device(&cells, View::Right, range), [0, 0, 10, 22, 10, 31]);
}
