use hsad::{
    features::{FeatureConfig, Keypoint},
    image::Size,
    internals::features::{
        hessian::{Grid, LAYERS},
        nonmax::integer_threshold,
    },
    verify::trials::NonmaxTrial,
};

use crate::common::{assert_twin, bench, keypoint, pictures};

const SIDE: u32 = 64;

/// The keypoints in an octave of a 64x64 picture whose determinants are 0 except for `samples`: (column, row, layer),
/// determinant. Also returns the number of keypoints found, which can exceed the capacity.
fn maxima_with(config: &FeatureConfig, octave: u32, samples: &[((u32, u32, u32), i32)]) -> (u32, Vec<Keypoint>) {
    let grids = (0..config.octaves).map(|octave| Grid::new((SIDE, SIDE), config.step, octave));
    let mut responses: Vec<_> = grids.map(|grid| vec![0; (LAYERS * grid.width * grid.height) as usize]).collect();
    let grid = Grid::new((SIDE, SIDE), config.step, octave);
    for &((i, j, k), determinant) in samples {
        responses[octave as usize][((k * grid.height + j) * grid.width + i) as usize] = determinant << 1 | 1;
    }
    NonmaxTrial { size: Size::new(SIDE, SIDE), config: config.clone(), responses }.keypoints(&bench()).unwrap()
}

/// The keypoints of [`maxima_with`], with a threshold of 100.
fn maxima(octave: u32, samples: &[((u32, u32, u32), i32)]) -> Vec<Keypoint> {
    let config = FeatureConfig { octaves: 2, threshold: 100.0 / (65280.0 * 65280.0), ..FeatureConfig::default() };
    assert_eq!(integer_threshold(config.threshold), 100);
    maxima_with(&config, octave, samples).1
}

#[test]
fn a_lone_peak_stays_where_it_is() {
    let found = maxima(0, &[((30, 31, 1), 1000)]);
    let response = 1000 << 1 | 1;
    assert_eq!(found, [Keypoint { response, index: 31 * 64 + 30, ..keypoint(30.0, 31.0, 2.0) }]);
}

#[test]
fn the_grid_of_octave_1_has_a_step_of_2() {
    let found = maxima(1, &[((16, 15, 1), 1000)]);
    assert_eq!((found[0].x, found[0].y), (32.0, 30.0));
    // Filter side 27 of octave 1: 1.2 * 27 / 9.
    assert!((found[0].scale - 3.6).abs() < 1e-6);
    assert_eq!(found[0].key(), (1, 15 * 32 + 16));
}

#[test]
fn parabolas_move_the_peak() {
    // Across: 0 1000 500, half of 500 over 1500. Between layers: 200 1000 0, half of -200 over 1800.
    let found = maxima(0, &[((30, 30, 2), 1000), ((31, 30, 2), 500), ((30, 30, 1), 200)]);
    assert_eq!(found.len(), 1);
    assert!((found[0].x - (30.0 + 1.0 / 6.0)).abs() < 1e-4, "{found:?}");
    assert_eq!(found[0].y, 30.0);
    // Side 21, 6 more than the layer below.
    assert!((found[0].scale - 1.2 * (21.0 - 6.0 / 18.0) / 9.0).abs() < 1e-5, "{found:?}");
    assert_eq!(found[0].index, (64 + 30) * 64 + 30);
}

/// A quadric through all 27 samples would put this peak more than half a sample away.
#[test]
fn no_peak_is_dropped() {
    let ridge = [((30, 30, 1), 1000), ((31, 30, 1), 990), ((30, 31, 1), 990), ((31, 31, 1), 999)];
    let found = maxima(0, &ridge);
    assert_eq!(found.len(), 1);
    // Half of 990 over 1010.
    assert!((found[0].x - 30.490_1).abs() < 1e-4 && (found[0].y - 30.490_1).abs() < 1e-4, "{found:?}");
}

/// Twice the curvature of the highest possible peak among the lowest values needs 32 bits.
#[test]
fn extreme_determinants_do_not_overflow() {
    let high = 29_013 * 29_013;
    let found = maxima(0, &[((30, 30, 1), high), ((29, 30, 1), -high), ((31, 30, 1), high), ((30, 29, 1), -high)]);
    assert_eq!((found[0].x, found[0].index), (30.5, 30 * 64 + 30));
    assert!((found[0].y - (30.0 + 0.5 / 3.0)).abs() < 1e-4, "{found:?}");
}

#[test]
fn the_earlier_of_equals_wins() {
    let index = |found: Vec<Keypoint>| found.iter().map(|k| k.index).collect::<Vec<_>>();
    let (early, late) = (30 * 64 + 30, 31 * 64 + 31);
    // In one block of 2x2, and across two blocks.
    assert_eq!(index(maxima(0, &[((30, 30, 1), 1000), ((31, 31, 1), 1000)])), [early]);
    assert_eq!(index(maxima(0, &[((31, 31, 1), 1000), ((32, 32, 1), 1000)])), [late]);
    assert_eq!(index(maxima(0, &[((31, 31, 1), 1000), ((30, 32, 1), 1000)])), [late]);
    // The layer comes before row and column.
    assert_eq!(index(maxima(0, &[((31, 31, 1), 1000), ((30, 30, 2), 1000)])), [late]);
    // Layer 0 has no maxima of its own, but beats those of layer 1.
    assert_eq!(index(maxima(0, &[((30, 30, 1), 1000), ((31, 31, 0), 1000)])), [0_u32; 0]);
    assert_eq!(index(maxima(0, &[((30, 30, 2), 1000), ((31, 31, 3), 1000)])), [64 * 64 + early]);
    assert_eq!(index(maxima(0, &[((30, 30, 2), 1000), ((31, 31, 3), 1001)])), [0_u32; 0]);
}

#[test]
fn the_threshold_is_reached_by_equality() {
    assert_eq!(maxima(0, &[((30, 30, 1), 100)]).len(), 1);
    assert_eq!(maxima(0, &[((30, 30, 1), 99)]).len(), 0);
}

#[test]
fn the_layer_above_must_fit_at_all_neighbours() {
    // Layer 1: the 21x21 filter reaches 10 px, and a neighbour is 1 px further out.
    for (at, found) in [(10, 0), (11, 1), (52, 1), (53, 0)] {
        assert_eq!(maxima(0, &[((at, 30, 1), 1000)]).len(), found, "column {at}");
        assert_eq!(maxima(0, &[((30, at, 1), 1000)]).len(), found, "row {at}");
    }
    // Layer 2: the 27x27 filter reaches 13 px.
    for (at, found) in [(13, 0), (14, 1), (49, 1), (50, 0)] {
        assert_eq!(maxima(0, &[((at, 30, 2), 1000)]).len(), found, "column {at}");
    }
}

#[test]
fn the_counter_goes_on_when_the_room_is_used_up() {
    let config = FeatureConfig { octaves: 1, max_features: 2, threshold: 1e-9, ..FeatureConfig::default() };
    let (count, kept) = maxima_with(&config, 0, &[((20, 30, 1), 900), ((30, 30, 1), 900), ((40, 30, 1), 900)]);
    assert_eq!((count, kept.len()), (3, 2));
}

#[test]
fn equals_the_twin() {
    let mut total = 0;
    for (name, picture) in pictures() {
        for (step, threshold) in [(1, 0.000_01), (2, 0.000_001)] {
            let config = FeatureConfig { octaves: 5, step, threshold, ..FeatureConfig::default() };
            let trial = NonmaxTrial::of_picture(&picture, config);
            assert_twin(&format!("{name}, step {step}"), &trial);
            total += trial.twins_keypoints().len();
        }
    }
    assert!(total > 1000, "{total}");
}
