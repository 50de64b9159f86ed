use hsad::{
    features::{FeatureConfig, hessian::Hessian},
    image::Luma,
    reference::{hessian::Octave, integral::IntegralImage},
};

use crate::common::{assert_same, download, gpu, integral_image, pictures, poison, run};

/// The responses of every octave.
fn responses(picture: &Luma, config: &FeatureConfig) -> Vec<Vec<i32>> {
    let (width, height) = picture.size();
    let stage = Hessian::new(&gpu().device, &integral_image(picture), width, height, config).unwrap();
    (0..config.octaves).for_each(|octave| poison(stage.responses(octave)));
    run(|encoder| stage.record(encoder));
    (0..config.octaves).map(|octave| download(stage.responses(octave))).collect()
}

fn one_octave(step: u32) -> FeatureConfig {
    FeatureConfig { octaves: 1, step, ..FeatureConfig::default() }
}

/// In 9x9 pixels the 9x9 filter fits only in the middle; everything else must be 0.
fn assert_only_the_middle(picture: &Luma, expected: i32) {
    for (step, middle, points) in [(1, 4 * 9 + 4, 81), (2, 2 * 5 + 2, 25)] {
        let mut all = vec![0; 4 * points];
        all[middle] = expected;
        assert_same(&format!("step {step}"), &responses(picture, &one_octave(step))[0], &all);
    }
}

#[test]
fn a_bright_pixel() {
    // Dxx = Dyy = 255 - 3 * 255 = -510; -510 * 256 / 81 rounds to -1612; Dxy = 0.
    let picture = Luma::from_fn(9, 9, |x, y| if (x, y) == (4, 4) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612) << 1);
}

#[test]
fn a_dark_pixel_has_a_positive_trace() {
    let picture = Luma::from_fn(9, 9, |x, y| if (x, y) == (4, 4) { 0 } else { 255 });
    assert_only_the_middle(&picture, (1612 * 1612) << 1 | 1);
}

#[test]
fn a_pixel_off_the_axes_makes_dxy() {
    // As above, and Dxy = 255; 0.9 * 255 * 256 / 81 rounds to 725.
    let picture = Luma::from_fn(9, 9, |x, y| if (x, y) == (5, 3) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612 - 725 * 725) << 1);
    // In the lower right quadrant Dxy = -255, and its square is the same.
    let picture = Luma::from_fn(9, 9, |x, y| if (x, y) == (5, 5) { 255 } else { 0 });
    assert_only_the_middle(&picture, (1612 * 1612 - 725 * 725) << 1);
    // At the corner only Dyy's rows and Dxx's columns miss it, and Dxy's quadrants end before it.
    let picture = Luma::from_fn(9, 9, |x, y| if (x, y) == (8, 8) { 255 } else { 0 });
    assert_only_the_middle(&picture, 0);
}

#[test]
fn every_layer_sees_a_pixel_in_its_middle() {
    let picture = Luma::from_fn(387, 387, |x, y| if (x, y) == (193, 193) { 255 } else { 0 });
    // Step 1, octave 0: the pixel is a grid point.
    let all = responses(&picture, &one_octave(1));
    for (layer, side) in [9_i32, 15, 21, 27].into_iter().enumerate() {
        let normalised = (f64::from(-510 * 256) / f64::from(side * side)).round() as i32;
        let at = layer * 387 * 387 + 193 * 387 + 193;
        assert_eq!(all[0][at], (normalised * normalised) << 1, "side {side}");
    }
}

#[test]
fn equals_the_twin() {
    for (name, picture) in pictures() {
        let integral = IntegralImage::new(&picture);
        for step in [1, 2] {
            let config = FeatureConfig { octaves: 5, step, ..FeatureConfig::default() };
            for (octave, found) in (0..).zip(responses(&picture, &config)) {
                let twin = Octave::new(&integral, octave, step);
                let expected: Vec<_> = twin.layers.iter().flat_map(|layer| layer.data()).map(|word| word.0).collect();
                assert_same(&format!("{name}, step {step}, octave {octave}"), &found, &expected);
            }
        }
    }
}
