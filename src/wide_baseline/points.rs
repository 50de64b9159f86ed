//! Matches at the positions of the interest points themselves, for geometry.

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use super::{DetectorCache, NEIGHBOURHOOD, View, WideBaselineConfig, agreement::agreement_of_scales, align, windows};
use crate::{
    backend::Backend,
    error::Result,
    features::Feature,
    image::Luma,
    matching::{Match, MatchConfig, Seed, match_features},
    rectify::Correspondence,
};

/// Smallest share of the neighbours that must agree with a match.
const LEAST_AGREEMENT: f32 = 0.25;

/// Corresponding points of two views of any size, turn and scale, in pixels of each view, the most certain first: the second
/// view is rotated and scaled like the first, and points are matched in any row and left where they were detected. Smoothing and
/// the search along rows of [`super::match_views`] are left out: rows are what these points measure.
///
/// `start` is a map from pixels of the second view to pixels of one that is turned and scaled like the first, as far as it is known:
/// [`super::Glance::map`].
///
/// Points of both views are detected in one orientation, so that a bias of the detector is the same in both and cancels.
///
/// # Errors
/// As [`super::match_views`].
pub(crate) async fn match_points(
    backend: &Backend,
    [first, second]: [&Luma; 2],
    WideBaselineConfig { features, matching, .. }: &WideBaselineConfig,
    start: DAffine2,
) -> Result<Vec<Correspondence>> {
    let mut detectors = DetectorCache::new(backend);
    let reach = NEIGHBOURHOOD * first.width().max(first.height()) as f32;
    let first = View::new(&mut detectors, first.clone(), features).await?;
    let align::Aligned { view: second, map, matches, .. } =
        align::align(&mut detectors, &first, second, features, matching, align::Goal::Descriptors, start).await?;
    let back = map.inverse();
    let found: Vec<Correspondence> = supported([&first.features, &second.features], &matches, reach).collect();
    let views = [&first.luma, &second.luma];
    let found: Vec<Correspondence> = found.into_par_iter().map(|point| windows::refined(views, point)).collect();
    let place = |Correspondence { left, right }| Correspondence { left, right: back.transform_point2(right) };
    Ok(found.into_iter().map(place).collect())
}

/// Corresponding points of two views that are not turned against each other, in rows that differ by at most `max_dy` pixels, or in
/// any rows.
///
/// # Errors
/// As [`super::match_views`].
pub(crate) async fn match_upright(
    backend: &Backend,
    [first, second]: [&Luma; 2],
    WideBaselineConfig { features, matching, .. }: &WideBaselineConfig,
    max_dy: Option<f32>,
) -> Result<Vec<Correspondence>> {
    let mut detectors = DetectorCache::new(backend);
    let reach = NEIGHBOURHOOD * first.width().max(first.height()) as f32;
    let first = detectors.features(first, features).await?;
    let second = detectors.features(second, features).await?;
    let matches = match_features(&first, &second, &MatchConfig { max_dy, ..matching.clone() })?;
    Ok(supported([&first, &second], &matches, reach).collect())
}

/// The matches that enough neighbours within `reach` pixels agree with.
fn supported([first, second]: [&[Feature]; 2], matches: &[Match], reach: f32) -> impl Iterator<Item = Correspondence> {
    let seeds: Vec<Seed> = matches.iter().map(|found| Seed::from_match(first, second, found)).collect();
    let growths: Vec<f32> = matches.iter().map(|found| second[found.right].scale / first[found.left].scale).collect();
    let shares = agreement_of_scales(&seeds, &growths, reach);
    let kept = seeds.into_iter().zip(shares).filter(|&(_, share)| share >= LEAST_AGREEMENT);
    let place = |x: f32, y: f32| DVec2::new(x.into(), y.into());
    kept.map(move |(seed, _)| Correspondence {
        left: place(seed.x, seed.y),
        right: place(seed.right_x(), seed.right_y()),
    })
}
