//! What is searched in each cell of the other view.

use hsad::{
    dense::View, disparity::DisparityRange, image::Plane, reference::CellPlane, verify::cells::PartnerRangesTrial,
};

use crate::common::*;

#[test]
fn the_twin_finds_the_same_ranges() {
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
                assert_twin(&what, &PartnerRangesTrial { cells: cells.clone(), view, range });
            }
        }
    }
}

#[test]
fn by_hand() {
    // The second of three cells, pixels 16 to 31 with disparities 5 to 20: from any of these to the first cell of the
    // right view, with 5 to 15 to the second.
    let range = DisparityRange::new(0, 50).unwrap();
    let cells: CellPlane = Plane::new(3, 1, vec![(0, 0), (5, 16), (0, 0)]).unwrap();
    let partners = |view| leaves(&PartnerRangesTrial { cells: cells.clone(), view, range }).remove(0);
    assert_eq!(partners(View::Left), vec![5_u32, 16, 5, 11, 0, 0].into());
    assert_eq!(partners(View::Right), vec![0_u32, 0, 5, 11, 5, 16].into());
}
