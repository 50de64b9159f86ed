//! Wide-baseline matching: interest points of one view matched to a second view without prior knowledge. The second
//! view may be rotated, scaled, blurred, noisy, or of another size.
//!
//! align (rotation, scale, rows) -> detect and match features, also with one view or both smoothed -> refine along
//! rows, from either view -> keep matches that their neighbours support. Pictures of one size share a detector.
//!
//! Constraints of a rectified pair, [`MatchConfig::max_dy`] and [`Rows::Equal`], apply only if rows were found to
//! correspond after the alignment.

mod agreement;
mod align;
mod detector_cache;
mod glance;
mod points;
mod windows;

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use crate::{
    backend::Backend,
    error::Result,
    features::{Feature, FeatureConfig},
    filter::gaussian,
    image::Luma,
    matching::{self, Match, MatchConfig, Rows, Seed, locate, match_features},
};
use detector_cache::DetectorCache;
pub(crate) use glance::{Glance, glance, grown};
pub(crate) use points::{match_points, match_upright};

/// Parameters of [`match_views`].
#[derive(Clone, Debug, PartialEq)]
pub struct WideBaselineConfig {
    /// Parameters of the interest point detector and descriptor; by default a threshold of 0.00003.
    pub features: FeatureConfig,
    /// Parameters of descriptor matching. `max_dy` is set to 1.5 px if rows correspond after the alignment.
    pub matching: MatchConfig,
    /// Whether the views are rotated, scaled and smoothed until they are alike, and only matches that their neighbours
    /// support are kept; true by default. Otherwise the views are matched as they are, in any row.
    pub adapt: bool,
}

impl Default for WideBaselineConfig {
    /// Accepts weaker points than seeding (threshold 0.00003): the best of more matches are better.
    fn default() -> Self {
        let features = FeatureConfig { threshold: 0.000_03, ..FeatureConfig::default() };
        Self { features, matching: MatchConfig::default(), adapt: true }
    }
}

impl WideBaselineConfig {
    /// Checks all parameters.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range, for a value outside it.
    pub fn validate(&self) -> Result<()> {
        self.features.validate()?;
        self.matching.validate()
    }
}

/// A match between two views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WideBaselineMatch {
    /// Position in the first view, in pixels.
    pub first: DVec2,
    /// Position in the second view, in pixels.
    pub second: DVec2,
    /// Confidence of the match, 0 to 1.
    pub confidence: f32,
    /// Indices of the matched features in [`WideBaselineMatches::features`], first view and second view.
    pub points: [usize; 2],
}

/// Result of [`match_views`].
#[derive(Clone, Debug)]
pub struct WideBaselineMatches {
    /// Interest points of both views. Positions and scales are in pixels of their own view; orientations and
    /// descriptors of the second view are those of the aligned picture.
    pub features: [Vec<Feature>; 2],
    /// Matches, the most confident first.
    pub matches: Vec<WideBaselineMatch>,
    /// Map from pixels of the second view to pixels of its aligned picture, rotated and scaled like the first view.
    pub alignment: DAffine2,
    /// Whether rows correspond after the alignment.
    pub rectified: bool,
    /// Standard deviations of the Gaussians that smoothed the first and the second view, in pixels; 0 for none.
    pub smoothing: [f64; 2],
}

/// Standard deviations of the Gaussians that are tried, in pixels, since it is unknown which view is blurred or noisy:
/// on one view, as long as more smoothing does not lose matches, and the first Gaussian on both views. 0 stands for
/// none.
const SIGMAS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
/// Smoothing must yield at least this factor more matches to be chosen, since it removes detail.
const CLEARLY_MORE: f64 = 1.25;
/// Largest row difference of features in corresponding rows, in pixels.
const MAX_DY: f32 = 1.5;
/// Left-right consistency: largest distance of a point after it was matched to the other view and back, in pixels.
const MAX_RETURN: f32 = 1.0;
/// Radius in which neighbours support a match, as a share of the first view's larger side.
const NEIGHBOURHOOD: f32 = 1.0 / 12.0;
/// Smallest share of the neighbours that must agree with a match.
const LEAST_AGREEMENT: f32 = 0.375;

/// A picture and its features.
struct View {
    luma: Luma,
    features: Vec<Feature>,
    /// Standard deviation of the Gaussian that smoothed the picture, in pixels; 0 for none.
    sigma: f64,
}

impl View {
    /// The features of an unsmoothed picture.
    async fn new(detectors: &mut DetectorCache<'_>, luma: Luma, config: &FeatureConfig) -> Result<Self> {
        let features = detectors.features(&luma, config).await?;
        Ok(Self { luma, features, sigma: 0.0 })
    }
}

/// A view smoothed by the first [`SIGMAS`], computed on demand.
struct SmoothedViews(Vec<View>);

impl SmoothedViews {
    /// The view smoothed by the Gaussian at `index` of [`SIGMAS`].
    async fn by(&mut self, index: usize, detectors: &mut DetectorCache<'_>, config: &FeatureConfig) -> Result<&View> {
        while self.0.len() <= index {
            let sigma = SIGMAS[self.0.len()];
            let luma = gaussian(&self.0[0].luma.map(|&grey| [grey]), sigma).map(|&[grey]| grey);
            self.0.push(View { sigma, ..View::new(detectors, luma, config).await? });
        }
        Ok(&self.0[index])
    }
}

/// Position of a match and the indices of its features.
type Indexed = (Seed, [usize; 2]);

/// Matches the interest points of `first` to `second`. The views may differ in size, rotation, scale and sharpness.
///
/// # Errors
/// [`crate::Error::Parameter`]; and as [`Backend::features`].
pub async fn match_views(
    backend: &Backend,
    first: &Luma,
    second: &Luma,
    config: &WideBaselineConfig,
) -> Result<WideBaselineMatches> {
    config.validate()?;
    let WideBaselineConfig { features, matching, adapt } = config;
    let mut detectors = DetectorCache::new(backend);
    let first = View::new(&mut detectors, first.clone(), features).await?;
    if !adapt {
        let second = View::new(&mut detectors, second.clone(), features).await?;
        let found = match_features(&first.features, &second.features, matching)?;
        let seeds = refined(&first, &second, &found, Rows::Matched);
        return Ok(in_picture_pixels([first, second], seeds, DAffine2::IDENTITY, false));
    }

    let reach = NEIGHBOURHOOD * first.luma.width().max(first.luma.height()) as f32;
    let mut firsts = SmoothedViews(vec![first]);
    // The first view is smoothed now, while the cached detector has its size: the aligned second view has another.
    firsts.by(1, &mut detectors, features).await?;
    let align::Aligned { view: second, map, rectified, .. } =
        align::align(&mut detectors, &firsts.0[0], second, features, matching, align::Goal::Rows, DAffine2::IDENTITY)
            .await?;
    let (rows, max_dy) = if rectified { (Rows::Equal, Some(MAX_DY)) } else { (Rows::Matched, matching.max_dy) };
    let matching = MatchConfig { max_dy, ..matching.clone() };
    let mut seconds = SmoothedViews(vec![second]);
    let mut found = async |[a, b]: [usize; 2]| -> Result<Vec<Indexed>> {
        let (first, second) =
            (firsts.by(a, &mut detectors, features).await?, seconds.by(b, &mut detectors, features).await?);
        let found = match_features(&first.features, &second.features, &matching)?;
        let mut seeds = refined(first, second, &found, rows);
        seeds.retain(|(seed, _)| is_consistent(first, second, seed, rows));
        Ok(with_support(seeds, reach))
    };
    let mut chosen = [0, 0];
    let mut seeds = found(chosen).await?;
    let plain = seeds.len();
    let mut needed = CLEARLY_MORE * plain as f64;
    let mut more_in = async |pair: [usize; 2]| -> Result<usize> {
        let other = found(pair).await?;
        let count = other.len();
        if count as f64 > needed {
            needed = count as f64;
            (chosen, seeds) = (pair, other);
        }
        Ok(count)
    };
    for only in [|index| [index, 0], |index| [0, index]] {
        let mut before = plain;
        for index in 1..SIGMAS.len() {
            let count = more_in(only(index)).await?;
            if count < before {
                break;
            }
            before = count;
        }
    }
    more_in([1, 1]).await?;
    let views = [firsts.0.swap_remove(chosen[0]), seconds.0.swap_remove(chosen[1])];
    Ok(in_picture_pixels(views, seeds, map, rectified))
}

/// Matches with a distinct cost minimum, refined to a fraction of a pixel, with the indices of their features.
fn refined(first: &View, second: &View, matches: &[Match], rows: Rows) -> Vec<Indexed> {
    let refine_one = |found: &Match| {
        let seed = Seed::from_match(&first.features, &second.features, found);
        let seed = locate((&first.luma, &second.luma), &seed, rows, window(first, second))?;
        Some((seed, [found.left, found.right]))
    };
    matches.par_iter().filter_map(refine_one).collect()
}

/// Half the side of the refinement window, in pixels. If one view was smoothed to resemble the other, both lack detail
/// finer than that Gaussian, and a larger window is needed for the same information.
fn window(first: &View, second: &View) -> i64 {
    matching::HALF + (first.sigma - second.sigma).abs().round() as i64
}

/// Left-right consistency of a match: whether the window around its position in the second view leads back to the
/// first. The window is lost at the edge of a surface, or at an occlusion.
fn is_consistent(first: &View, second: &View, seed: &Seed, rows: Rows) -> bool {
    let there =
        Seed { x: seed.right_x(), y: seed.right_y(), disparity: -seed.disparity, dy: -seed.dy, confidence: 1.0 };
    let back = locate((&second.luma, &first.luma), &there, rows, window(first, second));
    // The two disparities have opposite signs. They are compared instead of positions, which are whole pixels of each
    // view.
    back.is_some_and(|back| (back.disparity + seed.disparity).abs() <= MAX_RETURN)
}

/// Keeps the matches that enough neighbours agree with, and multiplies their confidence by the share that agrees.
fn with_support(seeds: Vec<Indexed>, reach: f32) -> Vec<Indexed> {
    let places: Vec<Seed> = seeds.iter().map(|(seed, _)| *seed).collect();
    let each = seeds.into_iter().zip(agreement::agreement(&places, reach));
    each.filter(|(_, share)| *share >= LEAST_AGREEMENT)
        .map(|((seed, points), share)| (Seed { confidence: seed.confidence * share, ..seed }, points))
        .collect()
}

/// Converts features and matches from pixels of the aligned views to pixels of the original pictures; `map` leads from
/// the second picture to its aligned view.
fn in_picture_pixels(
    [first, second]: [View; 2],
    seeds: Vec<Indexed>,
    map: DAffine2,
    rectified: bool,
) -> WideBaselineMatches {
    let smoothing = [first.sigma, second.sigma];
    let back = map.inverse();
    let place = |x: f32, y: f32| back.transform_point2(DVec2::new(x.into(), y.into()));
    let growth = back.matrix2.determinant().abs().sqrt() as f32;
    let mut matches: Vec<WideBaselineMatch> = seeds
        .into_iter()
        .map(|(seed, points)| WideBaselineMatch {
            first: DVec2::new(seed.x.into(), seed.y.into()),
            second: place(seed.right_x(), seed.right_y()),
            confidence: seed.confidence,
            points,
        })
        .collect();
    matches.sort_by(|a, b| b.confidence.total_cmp(&a.confidence).then(a.points.cmp(&b.points)));
    let moved = |feature: Feature| {
        let at = place(feature.x, feature.y);
        Feature { x: at.x as f32, y: at.y as f32, scale: growth * feature.scale, ..feature }
    };
    let features = [first.features, second.features.into_iter().map(moved).collect()];
    WideBaselineMatches { features, matches, alignment: map, rectified, smoothing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        eval::{Judged, PointMatch, Truth, conditions::Changed},
        gpu::DeviceChoice,
        image::Plane,
        io::Picture,
    };

    /// A picture of random blobs of several sizes.
    fn picture() -> Picture {
        let mut state = 5u32;
        let mut grey = vec![0.0f64; 200 * 160];
        for _ in 0..700 {
            let mut random = |end: u32| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 8) % end
            };
            let (x, y, radius) = (random(200) as i32, random(160) as i32, 2 + random(6) as i32);
            let value = f64::from(random(200)) - 100.0;
            for j in (y - radius).max(0)..(y + radius).min(160) {
                for i in (x - radius).max(0)..(x + radius).min(200) {
                    if (i - x).pow(2) + (j - y).pow(2) < radius * radius {
                        grey[(j * 200 + i) as usize] += value;
                    }
                }
            }
        }
        Picture::new((200, 160), grey.iter().map(|v| [(128.0 + v).clamp(0.0, 255.0) as u8; 4]).collect()).unwrap()
    }

    /// Matches of the picture with its changed copy, and their precision at 1.5 px.
    fn matched(condition: &str, adapt: bool) -> (WideBaselineMatches, f64) {
        let picture = picture();
        let changed = Changed::by(&[condition.parse().unwrap()], &picture, 1);
        let backend = Backend::open(&DeviceChoice::Cpu).unwrap();
        let config = WideBaselineConfig { adapt, ..WideBaselineConfig::default() };
        let found =
            pollster::block_on(match_views(&backend, &picture.luma(), &changed.picture.luma(), &config)).unwrap();
        let truth = Truth::stereo(Plane::filled((200, 160), 0.0), None).unwrap().changed(&changed);
        let matches: Vec<PointMatch> = found.matches.iter().map(PointMatch::from).collect();
        let judged = Judged::new(&matches, &truth, 1.5).unwrap();
        (found, judged.precision())
    }

    #[test]
    fn turned_views_are_turned_back() {
        for condition in ["rotation=90", "rotation=-37", "scale=1.4", "scale=0.7"] {
            let (found, precision) = matched(condition, true);
            assert!(found.rectified && found.matches.len() > 40 && precision > 0.97, "{condition}: {precision}");
        }
        let (found, _) = matched("rotation=90", false);
        assert!(found.matches.len() < 10);
    }

    #[test]
    fn what_is_blurred_is_compared_with_what_is_as_blurred() {
        let (found, precision) = matched("blur=2.5", true);
        assert!(found.smoothing[0] > 0.0 && found.smoothing[1] == 0.0, "{:?}", found.smoothing);
        assert!(precision > 0.97, "{precision}");
        let (plain, _) = matched("blur=2.5", false);
        assert!(found.matches.len() > 2 * plain.matches.len());
        let (found, precision) = matched("blur=3.5", true);
        assert!(found.smoothing == [3.0, 0.0] && precision > 0.97, "{:?}: {precision}", found.smoothing);
    }

    #[test]
    fn alike_views_stay_as_they_are() {
        let (found, precision) = matched("gain=0.8", true);
        assert_eq!((found.alignment, found.smoothing), (DAffine2::IDENTITY, [0.0; 2]));
        assert!(found.rectified && precision > 0.97 && found.matches.len() > 100);
        assert!(found.matches.is_sorted_by(|a, b| a.confidence >= b.confidence));
    }

    #[test]
    fn nothing_is_found_in_nothing() {
        let backend = Backend::open(&DeviceChoice::Cpu).unwrap();
        let (flat, tiny) = (Luma::filled((60, 50), 7), Luma::filled((1, 1), 0));
        for (first, second) in [(&flat, &flat), (&flat, &tiny), (&tiny, &flat)] {
            assert!(
                pollster::block_on(match_views(&backend, first, second, &WideBaselineConfig::default()))
                    .unwrap()
                    .matches
                    .is_empty()
            );
        }
    }
}
