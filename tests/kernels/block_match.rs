//! Block matching.

use hsad::{
    dense::{BlockMatch, Brightness, CELL, DenseConfig, Interpolation, Layout, Pad, Ranges, Tile, View, Wanted},
    disparity::{DisparityMap, DisparityRange, SCALE},
    gpu::WordTexture,
    image::{Luma, Plane},
    luma::pack,
    reference::{self, CellPlane},
};

use crate::common::*;

/// Padding and block matching of one view, nothing else: the words written.
fn on_device(
    left: &Luma,
    right: &Luma,
    view: View,
    config: &DenseConfig,
    ranges: Option<&CellPlane>,
    others: Option<(&DisparityMap, u32)>,
    (wanted, tile): (Wanted, Tile),
) -> Vec<i32> {
    let device = &gpu().device;
    let (width, height) = left.size();
    let layout = Layout::new(left.size(), 0, height, config, &[tile]).expect("a layout");
    let texture = WordTexture::new(device, "planes", layout.words()).expect("a texture");
    let planes = upload(&vec![0_u32; layout.words().next_multiple_of(2048) as usize]);
    let confidences = if wanted == Wanted::Matches { width.div_ceil(4) * height } else { 0 };
    let matches = upload(&vec![0_u32; (width * height + confidences) as usize]);
    let (pad, kernel) = (Pad::new(device), BlockMatch::new(device, config, view, wanted, tile));
    let ranges = match ranges {
        None => Ranges::whole(device, config.searched(width).unwrap()),
        Some(cells) => {
            let words: Vec<u32> = cells.data().iter().flat_map(|&(first, count)| [first, count]).collect();
            Ranges::of_cells(upload(&words), width)
        }
    };
    let [left_padding, right_padding] = layout.padding(Brightness::SAME);
    let dispatches = [
        pad.prepare(device, left_padding, &upload_luma(left), &planes),
        pad.prepare(device, right_padding, &upload_luma(right), &planes),
    ];
    let others = others.map(|(others, limit)| (upload(others.data()), limit));
    let others = others.as_ref().map(|(others, limit)| (others, *limit));
    let block_match = kernel.prepare(device, &layout, &texture, &ranges, others, (&matches, width * height));
    poison(&planes);
    poison(&matches);
    run(|encoder| {
        dispatches.iter().for_each(|dispatch| dispatch.record(encoder));
        texture.record(encoder, &planes);
        block_match.record(encoder);
    });
    download(&matches)
}

/// A pair with a step in it, its right view noisier than its left.
fn pair(width: u32, height: u32, seed: u32) -> (Luma, Luma) {
    let right = picture(width, height, seed);
    let noise = picture(width, height, seed + 1);
    let left = Luma::from_fn(width, height, |x, y| {
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

fn compare_tiled(
    what: &str,
    (left, right): (&Luma, &Luma),
    view: View,
    config: &DenseConfig,
    ranges: Option<&CellPlane>,
    tile: Tile,
) {
    let searched = DenseConfig { range: config.searched(left.width()).unwrap(), ..config.clone() };
    let mut expected = reference::block_match(left, right, view, &searched, ranges);
    let others = reference::winners(left, right, view.other(), &searched, None);
    for others in [None, Some((&others, 300))] {
        if let Some((others, max_difference)) = others {
            reference::check_consistency(&mut expected, view, others, max_difference);
        }
        let actual = on_device(left, right, view, config, ranges, others, (Wanted::Matches, tile));
        let (disparities, confidences) = actual.split_at(left.data().len());
        let what = format!("{what}, others {}", others.is_some());
        assert_same(&format!("{what}, disparities"), disparities, expected.disparity.data());
        let confidences_expected: Vec<i32> = pack(&expected.confidence).into_iter().map(u32::cast_signed).collect();
        assert_same(&format!("{what}, confidences"), confidences, &confidences_expected);
    }
    let winners = on_device(left, right, view, config, ranges, None, (Wanted::Winners, tile));
    let expected = reference::winners(left, right, view, &searched, ranges);
    assert_same(&format!("{what}, winners"), &winners, expected.data());
}

#[test]
fn the_twin_matches_the_same_at_any_size() {
    for (width, height) in SIZES {
        let (left, right) = pair(width, height, 11);
        for view in [View::Left, View::Right] {
            compare(&format!("{width}x{height} {view:?}"), (&left, &right), view, &config(7, 0, 17));
        }
    }
}

#[test]
fn tiles_leave_no_trace() {
    let (left, right) = pair(97, 33, 51);
    for tile in [Tile::SOFTWARE, Tile::SOFTWARE_WINNERS, Tile { quads: 3, height: 1 }] {
        compare_tiled(&format!("{tile:?}"), (&left, &right), View::Right, &config(7, 0, 17), None, tile);
    }
}

#[test]
fn the_twin_searches_the_same_cells() {
    let (left, right) = pair(130, 131, 61);
    // From nothing to everything, and from one end or the other.
    let parts = [(0, 0), (0, 30), (0, 1), (29, 1), (3, 9), (7, 23), (11, 2), (4, 4)];
    let cells =
        Plane::from_fn(130_u32.div_ceil(CELL), 131_u32.div_ceil(CELL), |x, y| parts[((3 * x + 5 * y) % 8) as usize]);
    for (view, tile) in
        [(View::Left, Tile::HARDWARE), (View::Right, Tile::SOFTWARE), (View::Left, Tile::SOFTWARE_WINNERS)]
    {
        for min in [0, -7, 2] {
            let what = format!("{view:?} {tile:?} from {min}");
            compare_tiled(&what, (&left, &right), view, &config(5, min, 30), Some(&cells), tile);
        }
    }
}

#[test]
fn the_twin_matches_the_same_with_any_window() {
    let (left, right) = pair(97, 33, 21);
    // The widest takes its compiler half a minute, so not all of them.
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
    for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
        for uniqueness in [0, 1, 15, 100] {
            let config = DenseConfig { interpolation, uniqueness, ..config(5, -2, 23) };
            compare(&format!("{interpolation:?}, {uniqueness} %"), (&left, &right), View::Left, &config);
        }
    }
}

#[test]
fn black_white_and_noise() {
    let black = Luma::filled(40, 30, 0);
    let white = Luma::filled(40, 30, 255);
    let noise = |seed| Luma::from_fn(40, 30, |x, y| picture(1, 1, seed + 40 * y + x).get(0, 0));
    for (left, right) in [(&black, &black), (&black, &white), (&white, &black), (&noise(1), &noise(5000))] {
        for window in [3, 15] {
            let config = DenseConfig { uniqueness: 5, ..config(window, -8, 17) };
            compare("extremes", (left, right), View::Left, &config);
        }
    }
}

#[test]
fn by_hand() {
    // A bright column in the dark, at 5 in the left view and at 3 in the right: disparity 2. A 3x3
    // window sees it from the columns 4, 5 and 6; no other window of the left view sees anything,
    // and a window without it costs nothing at any disparity that does not see it either.
    let view = |bright| Luma::from_fn(9, 1, |x, _| if x == bright { 100 } else { 0 });
    let config = DenseConfig { interpolation: Interpolation::None, ..config(3, 0, 4) };
    let winners = on_device(&view(5), &view(3), View::Left, &config, None, None, (Wanted::Winners, Tile::HARDWARE));
    let d = |whole: i32| whole * SCALE;
    // Column 2 sees the bright column of the right view at disparity 0, so that 1 is better; 3 at 0
    // and 1, and 4 is 2 from the only place that sees it at the same side of the window.
    let expected = [d(0), d(0), d(1), d(2), d(2), d(2), d(2), d(0), d(0)];
    assert_eq!(winners, expected);
}
