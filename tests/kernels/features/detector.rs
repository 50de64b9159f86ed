use std::f32::consts::PI;

use hsad::{
    Error,
    features::{Detected, Detector, Feature, FeatureConfig, detect},
    image::{Luma, Size},
    internals::cpu,
    luma::pack,
    verify::trials::FeaturesTrial,
};

use crate::common::{SIZES, assert_twin, bench, block_on, gpu, picture, pictures};

/// A Gaussian blob around a centre on a ground of 128.
fn blob(width: u32, height: u32, centre: (f32, f32), sigma: f32, height_of_blob: f32) -> Luma {
    Luma::from_fn((width, height), |x, y| {
        let (dx, dy) = (x as f32 - centre.0, y as f32 - centre.1);
        (128.0 + height_of_blob * (-(dx * dx + dy * dy) / (2.0 * sigma * sigma)).exp()).round() as u8
    })
}

fn strongest(features: &[Feature]) -> &Feature {
    features.iter().max_by(|a, b| a.response.total_cmp(&b.response)).expect("a feature")
}

#[test]
fn a_blob_is_found_where_it_is() {
    for (height, dark) in [(100.0, false), (-100.0, true)] {
        for (centre, sigma) in [((40.3, 50.8), 2.5), ((64.0, 47.5), 4.0), ((60.6, 60.2), 8.0)] {
            let picture = blob(128, 120, centre, sigma, height);
            let found = block_on(detect(gpu(), &picture, &FeatureConfig::default())).unwrap().features;
            let found = strongest(&found);
            assert!((found.x - centre.0).abs() < 0.2 && (found.y - centre.1).abs() < 0.2, "{centre:?}: {found:?}");
            assert!(found.scale / sigma > 0.6 && found.scale / sigma < 1.4, "sigma {sigma}: {}", found.scale);
            assert_eq!(found.dark, dark);
            assert_eq!(found.orientation, 0.0);
        }
    }
}

#[test]
fn pictures_of_any_size_are_accepted() {
    for Size { width, height } in SIZES {
        for upright in [true, false] {
            let config = FeatureConfig { upright, ..FeatureConfig::default() };
            let found = block_on(detect(gpu(), &picture((width, height), 6), &config)).unwrap().features;
            assert_eq!(found.is_empty(), width.min(height) < 30, "{width}x{height}: {}", found.len());
            for feature in found {
                assert!(feature.x >= 0.0 && feature.x < width as f32 && feature.y >= 0.0 && feature.y < height as f32);
                assert!((0.0..2.0 * PI).contains(&feature.orientation));
                let length = feature.descriptor.iter().map(|v| v * v).sum::<f32>().sqrt();
                assert!((length - 1.0).abs() < 1e-4);
            }
        }
    }
}

#[test]
fn the_same_picture_gives_the_same_list() {
    let picture = picture((311, 239), 7);
    let config = FeatureConfig { upright: false, ..FeatureConfig::default() };
    let first = block_on(detect(gpu(), &picture, &config)).unwrap().features;
    assert!(first.len() > 100, "{}", first.len());
    for _ in 0..3 {
        assert_eq!(block_on(detect(gpu(), &picture, &config)).unwrap().features, first);
    }
}

#[test]
fn a_detector_is_used_again_for_the_next_picture() {
    let (width, height) = (130, 131);
    let pictures = [picture((width, height), 8), Luma::filled((width, height), 9), picture((width, height), 10)];
    let config = FeatureConfig::default();
    let luma = bench().upload_luma(&pictures[0]).unwrap();
    let detector = block_on(Detector::new(gpu(), (width, height), &config)).unwrap();
    let input = block_on(detector.input(&luma)).unwrap();
    for picture in pictures {
        bench().write(&luma, &pack(&picture));
        bench().run(|encoder| detector.record(encoder, &input));
        let found = block_on(detector.read()).unwrap();
        assert_eq!(found, block_on(detect(gpu(), &picture, &config)).unwrap().features);
    }
}

#[test]
fn of_more_than_there_is_room_for_the_strongest_are_kept() {
    let picture = picture((311, 239), 7);
    let limited =
        |max_features| block_on(detect(gpu(), &picture, &FeatureConfig { max_features, ..FeatureConfig::default() }));
    let Detected { features: all, found } = limited(65_536).unwrap();
    assert_eq!(all.len(), found);
    assert_eq!(limited(found as u32).unwrap().features, all);
    for room in [1, found / 3, found - 1] {
        let kept = limited(room as u32).unwrap();
        assert_eq!((kept.features.len(), kept.found), (room, found));
        // The same points as all have, described as they are.
        assert!(all.iter().filter(|feature| kept.features.contains(feature)).eq(&kept.features));
        let config = FeatureConfig { max_features: room as u32, ..FeatureConfig::default() };
        let twin = cpu::features::detector::detect(&picture, &config).unwrap().features;
        let places = |features: &[Feature]| -> Vec<[f32; 2]> {
            features.iter().map(|feature| [feature.response, f32::from(u8::from(feature.dark))]).collect()
        };
        assert_eq!(places(&kept.features), places(&twin));
    }
}

#[test]
fn a_list_without_room_is_an_error_for_readers_that_say_so() {
    let picture = picture((311, 239), 7);
    let config = FeatureConfig { max_features: 20, ..FeatureConfig::default() };
    let luma = bench().upload_luma(&picture).unwrap();
    let detector = block_on(Detector::new(gpu(), picture.size(), &config)).unwrap();
    let input = block_on(detector.input(&luma)).unwrap();
    bench().run(|encoder| detector.record(encoder, &input));
    let error = block_on(detector.read()).unwrap_err();
    assert!(matches!(error, Error::TooManyFeatures { room: 20, .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains("max_features is 20") && text.contains("threshold"), "{text}");
    // What keeps the strongest leaves the detector as it was.
    assert_eq!(block_on(detector.detect(&luma)).unwrap().features.len(), 20);
    assert!(block_on(detector.read()).is_ok(), "the list holds the strongest");
}

#[test]
fn parameters_out_of_range_are_refused() {
    let config = FeatureConfig { octaves: 6, ..FeatureConfig::default() };
    let error = block_on(detect(gpu(), &picture((20, 20), 1), &config)).unwrap_err();
    assert!(matches!(error, Error::Parameter { name: "octaves", .. }), "{error}");
}

#[test]
fn equals_the_twin() {
    for upright in [true, false] {
        for (name, picture) in pictures() {
            let config = FeatureConfig { upright, threshold: 0.000_03, ..FeatureConfig::default() };
            assert_twin(&format!("{name}, upright {upright}"), &FeaturesTrial { picture, config });
        }
    }
}
