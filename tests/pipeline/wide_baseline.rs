//! Wide-baseline matching of a rotated, blurred, noisy or occluded second view, on a real pair with ground truth.

use std::path::Path;

use glam::{DAffine2, DVec2};
use hsad::{
    Backend,
    dense::View,
    eval::{
        Judged, PointMatch, Truth,
        conditions::{Changed, Condition},
        curves::accuracy_of_first,
        scene::SceneFiles,
    },
    gpu::{DeviceChoice, block_on},
    io::load::load,
    pipeline,
    wide_baseline::{WideBaselineConfig, match_views},
};

use crate::real;

/// The accuracy that the paper claims: 97 % of the 100 most confident matches are right.
#[test]
fn the_hundred_most_confident_are_right_whatever_happened_to_the_second_view() {
    let backend = Backend::open(&DeviceChoice::Best).or_else(|_| Backend::open(&DeviceChoice::Cpu)).unwrap();
    for (name, conditions, least) in [
        ("Art", &["gain=0.6", "rotation=45", "scale=0.8", "blur=2", "noise=10", "occlusion=0.3"][..], 100),
        // A sixth of the view is visible, and matches there do not determine the rows of the rest.
        ("Art", &["occlusion=0.6"], 25),
        ("Cones", &["blur=3", "clutter=0.5"], 100),
    ] {
        let Some(folder) = real(&format!("stereo/{name}")) else { continue };
        let scene = SceneFiles::find(&folder).unwrap()[0].read(View::Left).unwrap();
        let known = Truth::stereo(scene.truth, scene.non_occluded.as_ref()).unwrap();
        for condition in conditions {
            let changed = Changed::by(&[condition.parse::<Condition>().unwrap()], &scene.right, 1);
            let truth = known.clone().changed(&changed);
            let views = (&scene.left.luma(), &changed.picture.luma());
            let found = block_on(match_views(&backend, views.0, views.1, &WideBaselineConfig::default())).unwrap();
            let matches: Vec<PointMatch> = found.matches.iter().map(PointMatch::from).collect();
            let right = Judged::new(&matches, &truth, 1.5).unwrap().right;
            let accuracy = accuracy_of_first(&right, 100);
            assert!(right.len() >= least && accuracy >= 0.97, "{name}, {condition}: {accuracy} of {}", right.len());
        }
    }
}

/// Surfaces that are 2.4 to 3.3 times as large in one view as in the other: most of their points show only in views that are not reduced.
#[test]
fn marked_rows_correspond_after_a_zoom() {
    let Some(folder) = real("uncalibrated/zoom") else { return };
    let backend = Backend::open(&DeviceChoice::Best).or_else(|_| Backend::open(&DeviceChoice::Cpu)).unwrap();
    let [left, right] = ["img1.png", "img2.png"].map(|name| load(&folder.join(name)).unwrap());
    let pair = pipeline::rectify(&backend, (&left, &right)).unwrap();
    let text = std::fs::read_to_string(folder.join("points.txt")).unwrap();
    let mut errors = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> = line.split_whitespace().map(|number| number.parse().unwrap()).collect();
        let row = |view: usize| {
            let mark = DVec2::new(numbers[2 * view], numbers[2 * view + 1]);
            pair.rectification.rectified_of(view, mark).unwrap().y
        };
        errors.push((row(0) - row(1)).abs());
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(errors.len() == 13 && mean < 1.5, "{mean}: {errors:?}");
}

/// All pictures of a size share a detector; an earlier picture must leave no trace.
#[test]
fn points_are_those_of_a_detector_of_their_own() {
    let scene = SceneFiles::find(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/planes"))).unwrap();
    let scene = scene[0].read(View::Left).unwrap();
    let backend = Backend::open(&DeviceChoice::Best).or_else(|_| Backend::open(&DeviceChoice::Cpu)).unwrap();
    let (config, views) = (WideBaselineConfig::default(), [scene.left.luma(), scene.right.luma()]);
    let found = block_on(match_views(&backend, &views[0], &views[1], &config)).unwrap();
    assert_eq!((found.alignment, found.smoothing), (DAffine2::IDENTITY, [0.0; 2]));
    for (features, view) in found.features.iter().zip(&views) {
        assert!(
            features.len() > 500 && *features == block_on(backend.features(view, &config.features)).unwrap().features
        );
    }
}
