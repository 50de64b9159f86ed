use hsad::{
    features::{
        FeatureConfig,
        hessian::{Grid, Hessian, LAYERS},
        integral::Integral,
    },
    image::Luma,
};

use crate::common::{SIZES, assert_same, download, gpu, picture, poison, run, upload_luma};

/// The responses of every octave.
fn responses(picture: &Luma, config: &FeatureConfig) -> Vec<Vec<i32>> {
    let (width, height) = picture.size();
    let integral = Integral::new(&gpu().device, &upload_luma(picture), width, height).unwrap();
    let stage = Hessian::new(&gpu().device, integral.integral(), width, height, config).unwrap();
    (0..config.octaves).for_each(|octave| poison(stage.responses(octave)));
    run(|encoder| {
        integral.record(encoder);
        stage.record(encoder);
    });
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

/// The kernel for four points a thread against the one for one point a thread.
#[test]
fn both_tiles_agree_at_every_size() {
    for (width, height) in SIZES {
        let picture = picture(width, height, 2);
        let dense = responses(&picture, &one_octave(1)).remove(0);
        let sparse = responses(&picture, &one_octave(2)).remove(0);
        let (fine, coarse) = (Grid::new(width, height, 1, 0), Grid::new(width, height, 2, 0));
        let mut expected = Vec::new();
        for k in 0..LAYERS {
            for j in 0..coarse.height {
                expected.extend(
                    (0..coarse.width).map(|i| dense[((k * fine.height + 2 * j) * fine.width + 2 * i) as usize]),
                );
            }
        }
        assert_same(&format!("{width}x{height}"), &sparse, &expected);
    }
}

/// Octaves share filter sizes: 15 and 27 of octave 0 are the first two of octave 1, and so on.
#[test]
fn octaves_agree_where_they_share_a_filter() {
    let (width, height) = (450, 431);
    let config = FeatureConfig { octaves: 5, ..FeatureConfig::default() };
    let all = responses(&picture(width, height, 3), &config);
    for octave in 1..config.octaves {
        let (fine, coarse) = (Grid::new(width, height, 1, octave - 1), Grid::new(width, height, 1, octave));
        let mut nonzero = 0;
        for (k, below) in [(0, 1), (1, 3)] {
            for j in 0..coarse.height {
                for i in 0..coarse.width {
                    let value = all[octave as usize][((k * coarse.height + j) * coarse.width + i) as usize];
                    let same = ((below * fine.height + 2 * j) * fine.width + 2 * i) as usize;
                    assert_eq!(value, all[octave as usize - 1][same], "octave {octave}, layer {k}, ({i}, {j})");
                    nonzero += usize::from(value != 0);
                }
            }
        }
        assert!(nonzero > 50, "octave {octave}");
    }
}
