//! Matching compared with its definition: with a naive search, and under exchange and permutation.

use hsad::{
    disparity::DisparityRange,
    features::{DESCRIPTOR_LENGTH, Feature},
    matching::{Match, MatchConfig, match_features},
};
use proptest::prelude::*;

/// A feature at `(x, y)` whose descriptor is the direction of the given values, or zeros.
fn feature(x: f32, y: f32, dark: bool, values: &[f32]) -> Feature {
    let mut descriptor = [0.0; DESCRIPTOR_LENGTH];
    descriptor[..values.len()].copy_from_slice(values);
    let length = descriptor.iter().map(|v| v * v).sum::<f32>().sqrt();
    if length > 0.0 {
        descriptor.iter_mut().for_each(|v| *v /= length);
    }
    Feature { x, y, scale: 2.0, response: 0.001, dark, orientation: 0.0, descriptor }
}

fn features(most: usize) -> impl Strategy<Value = Vec<Feature>> {
    let one = (0.0f32..200.0, 0.0f32..100.0, any::<bool>(), prop::collection::vec(-1.0f32..1.0, DESCRIPTOR_LENGTH));
    prop::collection::vec(one.prop_map(|(x, y, dark, values)| feature(x, y, dark, &values)), 0..most)
}

fn configs() -> impl Strategy<Value = MatchConfig> {
    (
        0.5f32..=1.0,
        any::<bool>(),
        any::<bool>(),
        prop::option::of(0.0f32..60.0),
        prop::option::of((-100i32..50, 1u32..150)),
        prop::option::of(1usize..20),
    )
        .prop_map(|(ratio, mutual, same_contrast, max_dy, range, strongest)| MatchConfig {
            ratio,
            mutual,
            same_contrast,
            max_dy,
            disparities: range.map(|(min, count)| DisparityRange::new(min, count).unwrap()),
            strongest,
        })
}

fn distance(a: &Feature, b: &Feature) -> f32 {
    a.descriptor.iter().zip(&b.descriptor).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
}

fn admissible(config: &MatchConfig, left: &Feature, right: &Feature) -> bool {
    let disparity = left.x - right.x;
    (!config.same_contrast || left.dark == right.dark)
        && config.max_dy.is_none_or(|max_dy| (left.y - right.y).abs() <= max_dy)
        && config.disparities.is_none_or(|range| disparity >= range.min as f32 && disparity <= range.last() as f32)
}

/// The nearest admissible feature of the right view.
fn naive(config: &MatchConfig, query: &Feature, right: &[Feature]) -> Option<usize> {
    (0..right.len())
        .filter(|&i| admissible(config, query, &right[i]))
        .min_by(|&a, &b| distance(query, &right[a]).total_cmp(&distance(query, &right[b])))
}

fn pairs(matches: &[Match]) -> Vec<(usize, usize)> {
    let mut pairs: Vec<_> = matches.iter().map(|m| (m.left, m.right)).collect();
    pairs.sort_unstable();
    pairs
}

proptest! {
    #[test]
    fn every_match_keeps_what_was_promised(
        left in features(40), right in features(40), config in configs(),
    ) {
        let matches = match_features(&left, &right, &config).unwrap();
        prop_assert!(matches.len() <= config.strongest.unwrap_or(usize::MAX));
        let mut seen = (vec![false; left.len()], vec![false; right.len()]);
        for m in &matches {
            prop_assert!(admissible(&config, &left[m.left], &right[m.right]));
            prop_assert!((0.0..=1.0).contains(&m.confidence) && 1.0 - m.confidence <= config.ratio + 1e-6);
            prop_assert!((m.distance - distance(&left[m.left], &right[m.right])).abs() < 1e-5);
            prop_assert_eq!(Some(m.right), naive(&config, &left[m.left], &right));
            prop_assert!(!std::mem::replace(&mut seen.0[m.left], true), "left {} twice", m.left);
            prop_assert!(!std::mem::replace(&mut seen.1[m.right], true), "right {} twice", m.right);
        }
        for pair in matches.windows(2) {
            let key = |m: &Match| (m.left, m.right);
            prop_assert!(pair[0].confidence > pair[1].confidence
                || pair[0].confidence == pair[1].confidence && key(&pair[0]) < key(&pair[1]));
        }
    }

    #[test]
    fn mutual_matches_are_exactly_the_mutually_nearest(left in features(40), right in features(40)) {
        let config = MatchConfig { ratio: 1.0, ..Default::default() };
        let expected: Vec<_> = (0..left.len())
            .filter_map(|l| Some((l, naive(&config, &left[l], &right)?)))
            .filter(|&(l, r)| naive(&config, &right[r], &left) == Some(l))
            .collect();
        prop_assert_eq!(pairs(&match_features(&left, &right, &config).unwrap()), expected);
    }

    #[test]
    fn exchanging_the_views_exchanges_the_matches(
        left in features(40), right in features(40), config in configs(),
    ) {
        let config = MatchConfig { mutual: true, strongest: None, ..config };
        let exchanged = MatchConfig {
            disparities: config.disparities.map(|range| DisparityRange::new(-range.last(), range.count).unwrap()),
            ..config.clone()
        };
        let forward = match_features(&left, &right, &config).unwrap();
        let mut backward = match_features(&right, &left, &exchanged).unwrap();
        for m in &mut backward {
            std::mem::swap(&mut m.left, &mut m.right);
        }
        let sorted = |mut matches: Vec<Match>| { matches.sort_by_key(|m| m.left); matches };
        prop_assert_eq!(sorted(forward), sorted(backward));
    }

    #[test]
    fn order_of_the_lists_plays_no_part(
        (left, shuffled) in features(40).prop_flat_map(|all| {
            let order: Vec<usize> = (0..all.len()).collect();
            (Just(all), Just(order).prop_shuffle())
        }),
        right in features(40),
        config in configs(),
    ) {
        let permuted: Vec<Feature> = shuffled.iter().map(|&i| left[i].clone()).collect();
        let mut found = match_features(&permuted, &right, &config).unwrap();
        found.iter_mut().for_each(|m| m.left = shuffled[m.left]);
        prop_assert_eq!(found, match_features(&left, &right, &config).unwrap());
    }
}

/// Descriptor distances of 0.2 and 0.8, chords on the unit circle, give a ratio of 0.25.
#[test]
fn confidence_is_one_minus_the_ratio_to_the_rival() {
    let left = [feature(50.0, 10.0, false, &[1.0, 0.0])];
    let at_chord = |x: f32, chord: f32| {
        let angle = 2.0 * (chord / 2.0).asin();
        feature(x, 10.0, false, &[angle.cos(), angle.sin()])
    };
    let right = [at_chord(40.0, 0.2), at_chord(90.0, 0.8), at_chord(10.0, 1.0)];
    let config = MatchConfig { mutual: false, ..Default::default() };
    let found = match_features(&left, &right, &config).unwrap();
    assert_eq!((found.len(), found[0].left, found[0].right), (1, 0, 0));
    assert!((found[0].distance - 0.2).abs() < 1e-5, "{found:?}");
    assert!((found[0].confidence - 0.75).abs() < 1e-5, "{found:?}");
}

#[test]
fn second_detection_of_the_same_structure_is_no_rival() {
    let left = [feature(50.0, 10.0, false, &[1.0])];
    let right = [feature(40.0, 10.0, false, &[1.0, 0.1]), feature(41.0, 10.0, false, &[1.0, 0.11])];
    let config = MatchConfig { mutual: false, ..Default::default() };
    let found = match_features(&left, &right, &config).unwrap();
    assert!(found.len() == 1 && found[0].right == 0 && found[0].confidence > 0.8, "{found:?}");

    let apart = [right[0].clone(), Feature { x: 90.0, ..right[1].clone() }];
    assert!(match_features(&left, &apart, &config).unwrap().is_empty(), "a rival elsewhere is one");
}

#[test]
fn flat_surroundings_and_opposite_contrast_match_nothing() {
    let config = MatchConfig { ratio: 1.0, ..Default::default() };
    let flat = [feature(1.0, 1.0, false, &[])];
    assert!(match_features(&flat, &flat, &config).unwrap().is_empty());

    let (bright, dark) = ([feature(1.0, 1.0, false, &[1.0])], [feature(1.0, 1.0, true, &[1.0])]);
    assert!(match_features(&bright, &dark, &config).unwrap().is_empty());
    let either = MatchConfig { same_contrast: false, ..config };
    assert_eq!(match_features(&bright, &dark, &either).unwrap().len(), 1);
}

#[test]
fn values_that_are_no_numbers_match_nothing() {
    let good = feature(1.0, 1.0, false, &[1.0]);
    let mut odd = vec![good.clone(); 4];
    odd[0].x = f32::NAN;
    odd[1].y = f32::INFINITY;
    odd[2].descriptor[5] = f32::NAN;
    let config = MatchConfig { ratio: 1.0, ..Default::default() };
    assert_eq!(pairs(&match_features(&odd, &[good], &config).unwrap()), [(3, 0)]);
}

/// A NaN descriptor among more candidates than a block holds must not hide its neighbours.
#[test]
fn one_broken_descriptor_spoils_no_other() {
    let angle = |i: usize| feature(i as f32, 1.0, false, &[(i as f32 * 0.1).cos(), (i as f32 * 0.1).sin()]);
    let left: Vec<Feature> = (0..30).map(angle).collect();
    for broken in 0..30 {
        let mut right = left.clone();
        right[broken].descriptor[0] = f32::NAN;
        let config = MatchConfig { ratio: 1.0, ..Default::default() };
        let found = pairs(&match_features(&left, &right, &config).unwrap());
        let expected: Vec<_> = (0..30).filter(|&i| i != broken).map(|i| (i, i)).collect();
        assert_eq!(found, expected);
    }
}
