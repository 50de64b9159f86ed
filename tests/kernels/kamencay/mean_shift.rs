//! Mean-shift filtering.

use hsad::{
    image::{Plane, Size},
    kamencay::ModeSeeking,
    verify::{Values, trials::MeanShiftTrial},
};

use crate::{common::*, kamencay::compute::colours};

fn on_device(pixels: &Plane<u32>, seeking: ModeSeeking) -> Vec<u32> {
    match leaves(&MeanShiftTrial { pixels: pixels.clone(), seeking }).remove(0) {
        Values::U32(modes) => modes,
        other => panic!("modes are words, not {}", other.kind()),
    }
}

fn compare(what: &str, pixels: &Plane<u32>, seeking: ModeSeeking) {
    assert_twin(&format!("{what} {seeking:?}"), &MeanShiftTrial { pixels: pixels.clone(), seeking });
}

#[test]
fn the_twin_filters_the_same() {
    let words = |picture: &hsad::io::Picture| picture.map(|&pixel| u32::from_le_bytes(pixel));
    for Size { width, height } in SIZES {
        let pixels = words(&colours((width, height), 3));
        compare(&format!("{width}x{height}"), &pixels, ModeSeeking { radius: 5, range: 8, turns: 10 });
        compare(&format!("{width}x{height}"), &pixels, ModeSeeking { radius: 1, range: 60, turns: 3 });
    }
    let pixels = words(&colours((64, 48), 4));
    compare("all there is", &pixels, ModeSeeking { radius: 15, range: 255, turns: 65 });
    for (name, photograph) in photographs().into_iter().take(2) {
        compare(&name, &words(&photograph), ModeSeeking { radius: 3, range: 8, turns: 5 });
    }
}

#[test]
fn by_hand() {
    let grey = |level: u32| level | level << 8 | level << 16;
    let seeking = |range, turns| ModeSeeking { radius: 1, range, turns };
    let pixels = Plane::new((4, 1), [10, 13, 100, 107].map(grey).to_vec()).unwrap();
    // Greys that differ by 3 have distance 5.2 in RGB, by 7 distance 12.1. The mean of 10 and 13 is 11.5, rounded up.
    assert_eq!(on_device(&pixels, seeking(6, 1)), [12, 12, 100, 107].map(grey));
    // The mean of the other two is 103.5.
    assert_eq!(on_device(&pixels, seeking(13, 1)), [12, 12, 104, 104].map(grey));
    // All colours are in range: the second pixel climbs on with the third, to 41 at 1.0, and stays there.
    assert_eq!(on_device(&pixels, seeking(255, 1))[1], grey(41));
}

#[test]
fn edges_stay_and_grain_goes() {
    let pixels = Plane::from_fn((40, 20), |x, y| {
        let level = if x < 20 { 50 } else { 120 } + (7 * x + 5 * y) % 5;
        level | level << 8 | level << 16
    });
    let modes = on_device(&pixels, ModeSeeking { radius: 4, range: 12, turns: 20 });
    for (pixel, &mode) in modes.iter().enumerate() {
        let expected = if pixel % 40 < 20 { 52 } else { 122 };
        assert!((mode & 255).abs_diff(expected) <= 1, "pixel {pixel}: {}", mode & 255);
    }
}
