use hsad::{
    image::Luma,
    verify::{Values, trials::HessianTrial},
};

use crate::common::{assert_same, assert_twin, leaves, pictures};

/// The responses of the first octave.
fn responses(picture: &Luma, step: u32) -> Vec<i32> {
    let left = leaves(&HessianTrial { picture: picture.clone(), octaves: 1, step });
    let [Values::I32(responses)] = &left[..] else { panic!("a response a point") };
    responses.clone()
}

/// In 9x9 pixels the 9x9 filter fits only in the middle; all other responses must be 0.
fn assert_only_the_middle(picture: &Luma, expected: i32) {
    for (step, middle, points) in [(1, 4 * 9 + 4, 81), (2, 2 * 5 + 2, 25)] {
        let mut all = vec![0; 4 * points];
        all[middle] = expected;
        assert_same(&format!("step {step}"), &responses(picture, step), &all);
    }
}

#[test]
fn a_bright_pixel() {
    // Dxx = Dyy = 255 - 3 * 255 = -510; -510 * 256 / 81 rounds to -1612; Dxy = 0.
    let picture = Luma::from_fn((9, 9), |x, y| if (x, y) == (4, 4) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612) << 1);
}

#[test]
fn a_dark_pixel_has_a_positive_trace() {
    let picture = Luma::from_fn((9, 9), |x, y| if (x, y) == (4, 4) { 0 } else { 255 });
    assert_only_the_middle(&picture, (1612 * 1612) << 1 | 1);
}

#[test]
fn a_pixel_off_the_axes_makes_dxy() {
    // Dxx and Dyy as before, and Dxy = 255; 0.9 * 255 * 256 / 81 rounds to 725.
    let picture = Luma::from_fn((9, 9), |x, y| if (x, y) == (5, 3) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612 - 725 * 725) << 1);
    // In the lower right quadrant Dxy = -255, with the same square.
    let picture = Luma::from_fn((9, 9), |x, y| if (x, y) == (5, 5) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612 - 725 * 725) << 1);
    // At the corner only Dyy's rows and Dxx's columns miss it, and Dxy's quadrants end before it.
    let picture = Luma::from_fn((9, 9), |x, y| if (x, y) == (8, 8) { 255 } else { 0 });
    assert_only_the_middle(&picture, 0);
}

#[test]
fn every_layer_sees_a_pixel_in_its_middle() {
    let picture = Luma::from_fn((387, 387), |x, y| if (x, y) == (193, 193) { 255 } else { 0 });
    // Step 1, octave 0: the pixel is a grid point.
    let all = responses(&picture, 1);
    for (layer, side) in [9_i32, 15, 21, 27].into_iter().enumerate() {
        let normalised = (f64::from(-510 * 256) / f64::from(side * side)).round() as i32;
        let at = layer * 387 * 387 + 193 * 387 + 193;
        assert_eq!(all[at], (normalised * normalised) << 1, "side {side}");
    }
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        for step in [1, 2] {
            let trial = HessianTrial { picture: picture.clone(), octaves: 5, step };
            assert_twin(&format!("{name}, step {step}"), &trial);
        }
    }
}
