//! The disparity range to search, from the seeds and the coarse map.

use std::fmt;

use super::coarse::CoarseMap;
use crate::{
    dense::Brightness,
    disparity::DisparityRange,
    error::{Error, Result},
    image::Luma,
    mask::Mask,
    matching::Seed,
    names::names,
};

/// Smallest number of supported seeds whose extent counts. With 14 seeds, in a quarter of a scene, the extent missed 38 %
/// of the pixels.
const NEEDED: usize = 20;
/// Smallest number of supported seeds that place a range where the coarse map does not.
const FEW: usize = 5;
/// Share of the seeds that is cut off at either end: a repeated pattern has groups of wrong seeds, which support each
/// other.
const TAIL: f32 = 0.02;
/// Smallest number of seeds that is cut off at either end of [`NEEDED`] or more: the smallest group that supports itself.
const LEAST_TAIL: usize = 2;
/// Smallest margin at either end, in pixels.
const LEAST_MARGIN: f32 = 3.0;
/// Margins beyond the far and the near end of the seeds, as shares of their extent, where the coarse map says nothing.
/// Near objects are large, smooth and often cut by the border, and so bear few features or none.
const SEED_MARGINS: [f32; 2] = [0.15, 0.4];
/// Smallest margin where few seeds stand alone, as a share of the width of the picture.
const ALONE: f32 = 0.1;
/// Disparities that are searched first, as shares of the width of the picture.
const SPAN: [f32; 2] = [-0.05, 0.4];
/// Smallest share of the coarse map that lies on surfaces, 0 to 1. Sound pairs have 0.5 to 1, unrelated views 0.01 to
/// 0.15; where a bare wall fills most of the picture 0.27 was seen.
const COVERAGE: f32 = 0.2;
/// Share of the coarse map on surfaces from which they show the whole scene, 0 to 1.
const WHOLE: f32 = 0.5;
/// Largest share of the coarse map's surfaces at an end of the searched disparities, 0 to 1.
const AT_ENDS: f32 = 0.01;
/// Smallest share of the coarse map's surfaces that are evidence of disparities below 0, 0 to 1.
const NEGATIVE: f32 = 0.05;

/// Origin of an end of the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeEnd {
    /// The disparities of the seeds.
    Seeds,
    /// The disparities of the coarse map.
    CoarseMap,
    /// 0: neither seeds nor coarse map show a disparity below.
    Zero,
}

names!(RangeEnd, "the origin of the range", { Seeds => "seeds", CoarseMap => "coarse map", Zero => "nothing below zero" });

/// The disparity range to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundRange {
    /// The range, with margins, in pixels.
    pub range: DisparityRange,
    /// Smallest and largest disparity that was seen, in pixels.
    pub seen: [f32; 2],
    /// Origin of the smallest and of the largest disparity.
    pub ends: [RangeEnd; 2],
}

/// Neither the seeds nor the coarse map determine the disparity range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinSupport {
    /// Number of seeds, matched points with a distinct cost minimum.
    pub seeds: usize,
    /// Number of the seeds that their neighbours support.
    pub supported: usize,
    /// Share of the coarse map that lies on surfaces, 0 to 1.
    pub coverage: f32,
}

impl fmt::Display for ThinSupport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seeds, supported, coverage } = self;
        write!(
            f,
            "{seeds} points were found in both views and {supported} of them confirmed by their neighbours, but {NEEDED} are \
             needed; and the views correspond in {:.0} % of a small copy, but {:.0} % are needed",
            100.0 * coverage,
            100.0 * COVERAGE
        )
    }
}

impl std::error::Error for ThinSupport {}

impl From<ThinSupport> for Error {
    fn from(thin: ThinSupport) -> Self {
        Self::NoRange { reason: thin.to_string() }
    }
}

/// The range that the `supported` seeds and a coarse map span, with margins; `seeds` is the number of all seeds, `width`
/// that of the view in pixels.
///
/// The coarse map decides where it covers enough: it sees surfaces without features, and a repeated pattern does not
/// stretch it. The seeds widen it.
pub(super) fn disparity_range(
    width: u32,
    supported: &[Seed],
    seeds: usize,
    coarse: &CoarseMap,
) -> std::result::Result<FoundRange, ThinSupport> {
    let seeds_extent = extent(supported);
    let thin = ThinSupport { seeds, supported: supported.len(), coverage: coarse.coverage() };
    // A few seeds that lie farther apart than the usual disparities contradict each other, as those of unrelated views do.
    let longest = (SPAN[1] - SPAN[0]) * width as f32;
    match (coarse.extent(), seeds_extent) {
        (Some(surfaces), extent) if coarse.coverage() >= COVERAGE => {
            let seeds_extent = extent.filter(|_| supported.len() >= NEEDED).unwrap_or(surfaces);
            joined(surfaces, seeds_extent, coarse.error(), coarse.negative(), coarse.coverage()).map_err(|_| thin)
        }
        (_, Some([far, near])) if supported.len() >= NEEDED || supported.len() >= FEW && near - far <= longest => {
            let least = if supported.len() < NEEDED { ALONE * width as f32 } else { LEAST_MARGIN };
            let [before, beyond] = SEED_MARGINS.map(|share| (share * (near - far)).max(least));
            // A background without surfaces can lie as far as 0.
            let (least, end) = if far > 0.0 { (0.0, RangeEnd::Zero) } else { (far - before, RangeEnd::Seeds) };
            range([least, near + beyond])
                .map(|range| FoundRange { range, seen: [far, near], ends: [end, RangeEnd::Seeds] })
                .map_err(|_| thin)
        }
        _ => Err(thin),
    }
}

/// The coarse map of what is `seen` in the left view, over the usual disparities and those of the seeds; over all that the width allows if surfaces lie at an
/// end of the usual ones, or if hardly any surface was found.
///
/// # Errors
/// [`Error::SizesDiffer`].
pub(super) fn coarse_map(
    views: (&Luma, &Luma),
    seen: Option<&Mask>,
    supported: &[Seed],
    brightness: Brightness,
) -> Result<CoarseMap> {
    let width = views.0.width() as f32;
    let seeds = extent(supported).filter(|_| supported.len() >= NEEDED);
    let [low, high] = SPAN.map(|share| share * width);
    let [far, near] = seeds.map_or([low, high], |[far, near]| [far + low, near - low]);
    let most = width - 1.0;
    let coarse =
        |[far, near]: [f32; 2]| CoarseMap::new(views, seen, range([far.max(-most), near.min(most)])?, brightness);
    let usual = coarse([low.min(far), high.max(near)])?;
    if usual.coverage() >= COVERAGE && usual.at_ends() <= AT_ENDS {
        return Ok(usual);
    }
    coarse([-most, most])
}

/// Smallest and largest disparity of the seeds, without the tails.
fn extent(seeds: &[Seed]) -> Option<[f32; 2]> {
    let mut disparities: Vec<f32> = seeds.iter().map(|seed| seed.disparity).collect();
    disparities.sort_by(f32::total_cmp);
    let last = disparities.len().checked_sub(1)?;
    let least = if seeds.len() < NEEDED { 0 } else { LEAST_TAIL };
    let tail = least.max((TAIL * last as f32) as usize);
    Some([disparities[tail], disparities[last - tail]])
}

/// The range of surfaces and seeds, with margins of `error` px; `negative` is the share of surfaces below 0, `coverage` that of
/// the view on surfaces.
fn joined(surfaces: [f32; 2], seeds: [f32; 2], error: f32, negative: f32, coverage: f32) -> Result<FoundRange> {
    let margin = error.max(LEAST_MARGIN);
    let mut seen = [surfaces[0].min(seeds[0]), surfaces[1].max(seeds[1])];
    let origin = |of_surface: bool| if of_surface { RangeEnd::CoarseMap } else { RangeEnd::Seeds };
    let mut ends = [origin(surfaces[0] <= seeds[0]), origin(surfaces[1] >= seeds[1])];
    let mut far = seen[0] - margin;
    // Disparities below 0 are rare: cameras that look at one point, or views exchanged. Without evidence none is searched.
    // A background that bears no surface, such as tiles, can lie as far as 0.
    let reaches_zero = far < 0.0 || coverage < WHOLE;
    if reaches_zero && seeds[0] > -0.5 && negative < NEGATIVE && seen[1] >= 0.0 {
        far = 0.0;
        seen[0] = seen[0].max(0.0);
        ends[0] = RangeEnd::Zero;
    }
    Ok(FoundRange { range: range([far, seen[1] + margin])?, seen, ends })
}

/// Whether `range`, which may end at 0 since nothing lies below, holds the surfaces of a coarse map with at least half of the margins that
/// [`joined`] leaves.
pub(super) fn holds(coarse: &CoarseMap, range: DisparityRange, ends_at_zero: bool) -> bool {
    let Some([far, near]) = coarse.extent().filter(|_| coarse.coverage() >= COVERAGE) else { return false };
    let margin = coarse.error().max(LEAST_MARGIN) / 2.0;
    let is_above = if ends_at_zero { coarse.negative() < NEGATIVE } else { far - margin >= range.min as f32 };
    is_above && near + margin <= range.last() as f32
}

/// The whole disparities that hold `[far, near]`.
fn range([far, near]: [f32; 2]) -> Result<DisparityRange> {
    DisparityRange::inclusive(far.floor() as i32, near.ceil() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds(disparities: impl IntoIterator<Item = f32>) -> Vec<Seed> {
        let seed = |disparity| Seed { x: 0.0, y: 0.0, disparity, dy: 0.0, confidence: 1.0 };
        disparities.into_iter().map(seed).collect()
    }

    #[test]
    fn a_few_seeds_of_a_repeated_pattern_do_not_stretch_the_range() {
        let mut disparities: Vec<f32> = (0..198).map(|i| 10.0 + (i % 40) as f32).collect();
        disparities.extend([-164.0, 100.0]);
        let [far, near] = extent(&seeds(disparities)).unwrap();
        assert_eq!([far, near], [10.0, 49.0]);
        assert_eq!(extent(&[]), None);
        // Two of 40 at either end; none of fewer than 20.
        let pairs = |sound: usize| seeds([-190.0; 2].into_iter().chain([7.0].repeat(sound)).chain([90.0; 2]));
        assert_eq!(extent(&pairs(36)), Some([7.0; 2]));
        assert_eq!(extent(&pairs(15)), Some([-190.0, 90.0]));
    }

    #[test]
    fn surfaces_and_seeds_together_by_hand() {
        // Surfaces from 12 to 60 px, seeds from 20 to 62.5; a margin of 6 px on both sides.
        let found = joined([12.0, 60.0], [20.0, 62.5], 6.0, 0.0, 0.9).unwrap();
        assert_eq!((found.range.min, found.range.last()), (6, 69));
        assert_eq!((found.seen, found.ends), ([12.0, 62.5], [RangeEnd::CoarseMap, RangeEnd::Seeds]));
        // A margin of at least 3 px.
        let exact = joined([12.0, 60.0], [12.0, 60.0], 1.5, 0.0, 0.9).unwrap();
        assert_eq!((exact.range.min, exact.range.last()), (9, 63));
        // Most of the view bears no surface.
        let partial = joined([12.0, 60.0], [12.0, 60.0], 1.5, 0.0, 0.49).unwrap();
        assert_eq!((partial.range.min, partial.range.last(), partial.ends[0]), (0, 63, RangeEnd::Zero));
    }

    #[test]
    fn disparities_below_zero_need_evidence() {
        let range = |surfaces, seeds, negative| {
            let found = joined(surfaces, seeds, 6.0, negative, 0.9).unwrap();
            (found.range.min, found.ends[0])
        };
        assert_eq!(range([2.0, 60.0], [1.0, 60.0], 0.0), (0, RangeEnd::Zero));
        assert_eq!(range([-12.0, 60.0], [11.0, 60.0], 0.009), (0, RangeEnd::Zero));
        assert_eq!(range([-12.0, 60.0], [11.0, 60.0], 0.1), (-18, RangeEnd::CoarseMap));
        assert_eq!(range([2.0, 60.0], [-4.0, 60.0], 0.0), (-10, RangeEnd::Seeds));
    }

    #[test]
    fn thin_support_is_an_error_with_figures() {
        let thin = ThinSupport { seeds: 40, supported: 19, coverage: 0.04 };
        let message = Error::from(thin).to_string();
        for part in ["40 points", "19 of them", "4 % of a small copy"] {
            assert!(message.contains(part), "'{part}' in: {message}");
        }
    }
}
