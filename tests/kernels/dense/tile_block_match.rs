//! Block matching with a tile per workgroup; see also `block_match.rs`, whose pairs it matches too.

use hsad::{
    dense::{Aggregation, Compared, DenseConfig, DenseParameters, Search, View},
    disparity::DisparityRange,
    image::{Luma, Plane},
    internals::dense::{CELL, Tile},
    verify::trials::BlockMatchTrial,
};

use crate::common::*;

fn pair(width: u32, height: u32) -> [Luma; 2] {
    let (right, noise) = (picture((width, height), 5), picture((width, height), 6));
    let left = Luma::from_fn((width, height), |x, y| {
        let value = right.get_clamped(i64::from(x) - if y < height / 2 { 3 } else { 9 }, i64::from(y));
        value.saturating_add(noise.get(x, y) % 16)
    });
    [left, right]
}

fn config(side: u32, (min, count): (i32, u32), search: Search) -> DenseConfig {
    let aggregation = Aggregation::Sad { side, search, compared: Compared::Luma };
    let parameters = DenseParameters { aggregation, uniqueness: 10, ..DenseParameters::default() };
    DenseConfig { parameters, ..DenseConfig::new(DisparityRange::new(min, count).unwrap()) }
}

fn assert_same(
    what: &str,
    [left, right]: [Luma; 2],
    view: View,
    config: DenseConfig,
    ranges: Option<Plane<(u32, u32)>>,
) {
    for consistency in [None, Some(300)] {
        let (left, right, ranges) = (left.clone(), right.clone(), ranges.clone());
        let config = config.clone().with(|parameters| parameters.consistency = consistency);
        let trial = BlockMatchTrial { left, right, view, config, ranges, tile: Tile::HARDWARE };
        assert_twin(&format!("{what}, {view:?}, {consistency:?}"), &trial);
    }
}

/// Windows whose columns reach into those of a second thread, and ranges that begin within a step.
#[test]
fn any_window_and_any_range() {
    for side in (3..=31).step_by(4) {
        for (view, range) in [(View::Left, (-5, 22)), (View::Right, (2, 17))] {
            assert_same(&format!("window {side}"), pair(131, 37), view, config(side, range, Search::Whole), None);
        }
    }
}

/// Cells of one workgroup search different ranges, from empty to whole.
#[test]
fn each_cell_searches_its_own_range() {
    let parts = [(0, 0), (0, 30), (0, 1), (29, 1), (3, 9), (7, 23), (11, 2), (4, 4)];
    let cells =
        Plane::from_fn((130_u32.div_ceil(CELL), 67_u32.div_ceil(CELL)), |x, y| parts[((3 * x + 5 * y) % 8) as usize]);
    for view in View::ALL {
        assert_same("cells", pair(130, 67), view, config(7, (-3, 30), Search::CoarseToFine), Some(cells.clone()));
    }
}
