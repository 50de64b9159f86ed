//! Block matching.

use hsad::{
    dense::{Aggregation, Compared, DenseConfig, Interpolation, Search, View},
    disparity::{DisparityRange, SCALE},
    image::{Luma, Plane, Size},
    internals::{
        cpu::dense::CellPlane,
        dense::{CELL, Tile},
    },
    verify::trials::BlockMatchTrial,
};

use crate::common::*;

/// A pair with a step in it, its right view noisier than its left.
fn pair(width: u32, height: u32, seed: u32) -> (Luma, Luma) {
    let right = picture((width, height), seed);
    let noise = picture((width, height), seed + 1);
    let left = Luma::from_fn((width, height), |x, y| {
        let disparity = if y < height / 2 { 3 } else { 9 };
        let value = right.get_clamped(i64::from(x) - disparity, i64::from(y));
        value.saturating_add(noise.get(x, y) % 16)
    });
    (left, right)
}

fn config(window: u32, min: i32, count: u32) -> DenseConfig {
    DenseConfig::new(DisparityRange::new(min, count).unwrap()).with_window(window)
}

fn compare(what: &str, views: (&Luma, &Luma), view: View, config: &DenseConfig) {
    compare_tiled(what, views, view, config, None, Tile::HARDWARE);
}

/// Compares without and with a left-right consistency check.
fn compare_tiled(
    what: &str,
    (left, right): (&Luma, &Luma),
    view: View,
    config: &DenseConfig,
    ranges: Option<&CellPlane>,
    tile: Tile,
) {
    for consistency in [None, Some(300)] {
        let (left, right, ranges) = (left.clone(), right.clone(), ranges.cloned());
        let config = config.clone().with(|parameters| parameters.consistency = consistency);
        let what = format!("{what}, {consistency:?}");
        assert_twin(&what, &BlockMatchTrial { left, right, view, config, ranges, tile });
    }
}

#[test]
fn the_twin_matches_the_same_at_any_size() {
    for Size { width, height } in SIZES {
        let (left, right) = pair(width, height, 11);
        for view in [View::Left, View::Right] {
            compare(&format!("{width}x{height} {view:?}"), (&left, &right), view, &config(7, 0, 17));
        }
    }
}

#[test]
fn tiles_leave_no_trace() {
    let (left, right) = pair(97, 33, 51);
    for tile in [Tile::SMALL, Tile::LARGE, Tile { quads: 3, height: 1, across: 3, down: 5 }] {
        for window in [7, 11] {
            let what = format!("{tile:?}, window {window}");
            compare_tiled(&what, (&left, &right), View::Right, &config(window, 0, 17), None, tile);
        }
    }
}

#[test]
fn the_twin_searches_the_same_cells() {
    let (left, right) = pair(130, 131, 61);
    // Ranges from empty to whole, at either end.
    let parts = [(0, 0), (0, 30), (0, 1), (29, 1), (3, 9), (7, 23), (11, 2), (4, 4)];
    let (columns, rows) = (130_u32.div_ceil(CELL), 131_u32.div_ceil(CELL));
    let cells = Plane::from_fn((columns, rows), |x, y| parts[((3 * x + 5 * y) % 8) as usize]);
    for (view, tile) in [
        (View::Left, Tile::HARDWARE),
        (View::Right, Tile::HARDWARE),
        (View::Left, Tile::SMALL),
        (View::Left, Tile::LARGE),
    ] {
        for min in [0, -7, 2] {
            let what = format!("{view:?} {tile:?} from {min}");
            compare_tiled(&what, (&left, &right), view, &config(5, min, 30), Some(&cells), tile);
        }
    }
}

#[test]
fn the_other_view_is_asked_at_half_the_size() {
    for Size { width, height } in SIZES {
        let (left, right) = pair(width, height, 71);
        for (view, tile) in [(View::Left, Tile::HARDWARE), (View::Right, Tile::LARGE)] {
            for min in [0, -9] {
                let aggregation = Aggregation::Sad { side: 7, search: Search::CoarseToFine, compared: Compared::Luma };
                let config = config(7, min, 21).with(|parameters| parameters.aggregation = aggregation);
                let what = format!("{width}x{height} {view:?} from {min}");
                compare_tiled(&what, (&left, &right), view, &config, None, tile);
            }
        }
    }
}

#[test]
fn the_twin_matches_the_same_with_any_window() {
    let (left, right) = pair(97, 33, 21);
    // A selection of windows: the widest takes half a minute to compile.
    for window in [3, 5, 9, 11, 13, 17] {
        compare(&format!("window {window}"), (&left, &right), View::Left, &config(window, -3, 30));
    }
}

#[test]
fn the_twin_matches_the_same_in_any_range() {
    let (left, right) = pair(97, 33, 31);
    for (min, count) in [(0, 1), (0, 2), (5, 3), (-20, 41), (-96, 193), (-500, 1000), (90, 100), (-97 - 40, 45)] {
        for view in [View::Left, View::Right] {
            compare(&format!("{count} from {min}, {view:?}"), (&left, &right), view, &config(3, min, count));
        }
    }
}

#[test]
fn the_twin_decides_the_same_with_any_check() {
    let (left, right) = pair(130, 131, 41);
    for interpolation in Interpolation::ALL {
        for uniqueness in [0, 1, 15, 100] {
            let config = config(5, -2, 23).with(|parameters| {
                parameters.interpolation = interpolation;
                parameters.uniqueness = uniqueness;
            });
            compare(&format!("{interpolation:?}, {uniqueness} %"), (&left, &right), View::Left, &config);
        }
    }
}

#[test]
fn black_white_and_noise() {
    let black = Luma::filled((40, 30), 0);
    let white = Luma::filled((40, 30), 255);
    let noise = |seed| Luma::from_fn((40, 30), |x, y| picture((1, 1), seed + 40 * y + x).get(0, 0));
    for (left, right) in [(&black, &black), (&black, &white), (&white, &black), (&noise(1), &noise(5000))] {
        for window in [3, 15] {
            let config = config(window, -8, 17).with(|parameters| parameters.uniqueness = 5);
            compare("extremes", (left, right), View::Left, &config);
        }
    }
}

#[test]
fn by_hand() {
    // A bright column in the dark, at 5 in the left view and at 3 in the right: disparity 2. Of the left view's 3x3
    // windows, only those around columns 4, 5 and 6 contain it; all others are black and cost nothing at any disparity
    // whose window is black too.
    let view = |bright| Luma::from_fn((9, 1), |x, _| if x == bright { 100 } else { 0 });
    let config = config(3, 0, 4).with(|parameters| parameters.interpolation = Interpolation::None);
    let (left, right) = (view(5), view(3));
    let left = leaves(&BlockMatchTrial { left, right, view: View::Left, config, ranges: None, tile: Tile::HARDWARE });
    let d = |whole: i32| whole * SCALE;
    // The window of column 2 meets the right view's bright column at disparity 0, so that 1 is better; that of column 3
    // at 0 and 1; column 4 has disparity 2, the only one with the bright column at the same side of both windows.
    let expected = vec![d(0), d(0), d(1), d(2), d(2), d(2), d(2), d(0), d(0)];
    // Outputs: disparities, confidences, winners.
    assert_eq!(left[2], expected.into());
}
