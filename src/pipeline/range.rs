//! The disparity range to search, and its ends in the map.

use crate::{
    config::Config,
    disparity::{DisparityMap, DisparityRange, NONE},
    error::{Error, Result},
    seeding::{FoundRange, RangeEnd, Seeding, ThinSupport},
};

/// Largest share of the map's disparities at an end of a range that holds the scene, 0 to 1. Ten sound scenes have at most
/// 0.003; a range that cuts 5 % of the truth has at least 0.13.
const MOST_AT_END: f32 = 0.02;
/// Smallest share of seeds or surfaces in the range to search, 0 to 1.
const SEEN: f32 = 0.05;

/// Origin of the disparity range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangeSource {
    /// Set by [`Config::range`].
    Asked,
    /// Found from the seeds and the coarse map: origin of the smallest and of the largest disparity.
    Found([RangeEnd; 2]),
    /// Unknown: a quarter of the width of the picture, from [`Config::least`] or 0 upwards.
    Fallback(ThinSupport),
}

impl RangeSource {
    /// Whether the range ends at 0 since nothing below 0 was seen.
    pub(super) fn ends_at_zero(self) -> bool {
        matches!(self, Self::Found([RangeEnd::Zero, _]))
    }
}

/// The range to search in views of `width` px, and its origin.
///
/// # Errors
/// [`Error::NoRange`] if what was found lies below [`Config::least`].
pub(super) fn range_to_search(config: &Config, seeding: &Seeding, width: u32) -> Result<(DisparityRange, RangeSource)> {
    Ok(match (config.range, seeding.range) {
        (Some(range), _) => (range, RangeSource::Asked),
        (None, Ok(found)) => {
            let least = config.least.unwrap_or(found.range.min);
            (not_below(&found, least, share_not_below(seeding, least))?, RangeSource::Found(found.ends))
        }
        (None, Err(thin)) => {
            let range = DisparityRange::new(config.least.unwrap_or(0), width.div_ceil(4))?;
            (range, RangeSource::Fallback(thin))
        }
    })
}

/// The shares of the map's disparities within 1.5 px of the smallest and of the largest disparity of `range`, 0 to 1.
pub(super) fn at_ends(map: &DisparityMap, range: DisparityRange) -> [f32; 2] {
    let known = map.data().iter().filter(|&&disparity| disparity != NONE);
    let (mut count, mut ends) = (0, [0; 2]);
    for &disparity in known {
        count += 1;
        let [low, high] = range.is_at_end(disparity);
        ends[0] += u32::from(low);
        ends[1] += u32::from(high);
    }
    ends.map(|end| end as f32 / count.max(1) as f32)
}

/// Whether the map of a range that was found touches an end of the range, as surfaces do that go on beyond the end.
pub(super) fn is_cut(source: RangeSource, ends: [f32; 2]) -> bool {
    let RangeSource::Found(_) = source else { return false };
    ends[0] > MOST_AT_END && !source.ends_at_zero() || ends[1] > MOST_AT_END
}

/// A wider range, if the map of a range that was found touches an end of the range, as surfaces do that go on beyond the end;
/// within what a `width` of the views in pixels allows.
/// A range that does not reach below 0 stays so, since neither seeds nor coarse map show a disparity there.
pub(super) fn widened(
    range: DisparityRange,
    source: RangeSource,
    ends: [f32; 2],
    least: Option<i32>,
    width: u32,
) -> Option<DisparityRange> {
    let RangeSource::Found(_) = source else { return None };
    let more = (range.count / 2).max(16).cast_signed();
    let down = ends[0] > MOST_AT_END && !source.ends_at_zero();
    let up = ends[1] > MOST_AT_END;
    let most = width.cast_signed() - 1;
    let lowest = if range.min < 0 { -most } else { 0 };
    let min = if down { (range.min - more).max(least.unwrap_or(lowest)).max(lowest) } else { range.min };
    let last = if up { (range.last() + more).min(most) } else { range.last() };
    let wider = DisparityRange::inclusive(min, last).ok()?;
    (wider != range).then_some(wider)
}

/// The share of the seeds, or of the surfaces if that is larger, that is not below `least`, 0 to 1.
fn share_not_below(seeding: &Seeding, least: i32) -> f32 {
    let least = least as f32;
    let seeds = seeding.seeds.iter().filter(|seed| seed.disparity >= least).count();
    let seeds = seeds as f32 / seeding.seeds.len().max(1) as f32;
    seeds.max(seeding.coarse.not_below(least))
}

/// The part of a found range that is not below `least`, which holds `share` of what was seen.
fn not_below(found: &FoundRange, least: i32, share: f32) -> Result<DisparityRange> {
    let range = found.range;
    if least <= range.min {
        return Ok(range);
    }
    // A margin alone is no range, nor are the wrong surfaces of exchanged views.
    if share >= SEEN && least <= range.last() {
        return DisparityRange::inclusive(least, range.last());
    }
    Err(Error::NoRange {
        reason: format!(
            "the views show {:.0} to {:.0} px and nothing below {least} is to be searched; if left and right are mixed up, \
             exchange them",
            found.seen[0], found.seen[1],
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{disparity::SCALE, image::Plane};

    #[test]
    fn ends_by_hand() {
        let range = DisparityRange::inclusive(2, 9).unwrap();
        // 3.5 and 7.5 px are at an end, 3.6 and 7.4 are not.
        let map = Plane::new((6, 1), vec![NONE, 2 * SCALE, 896, 921, 1894, 1920]).unwrap();
        assert_eq!(at_ends(&map, range), [0.4, 0.2]);
        assert_eq!(at_ends(&map.map(|_| NONE), range), [0.0, 0.0]);
    }

    #[test]
    fn a_range_grows_where_the_map_touches_its_end() {
        let range = DisparityRange::inclusive(10, 49).unwrap();
        let found = |low| RangeSource::Found([low, RangeEnd::CoarseMap]);
        let wider =
            |source, ends, least| widened(range, source, ends, least, 60).map(|range| (range.min, range.last()));
        assert_eq!(wider(found(RangeEnd::Seeds), [0.02, 0.0], None), None);
        assert_eq!(wider(found(RangeEnd::Seeds), [0.03, 0.0], None), Some((0, 49)));
        assert_eq!(wider(found(RangeEnd::Seeds), [0.03, 0.5], Some(4)), Some((4, 59)));
        assert_eq!(wider(found(RangeEnd::Zero), [0.03, 0.0], None), None);
        assert_eq!(wider(found(RangeEnd::Seeds), [0.0, 0.5], None), Some((10, 59)), "no further than the width");
        assert_eq!(wider(RangeSource::Asked, [0.5, 0.5], None), None);
        let negative = DisparityRange::inclusive(-4, 35).unwrap();
        let wider = widened(negative, found(RangeEnd::Seeds), [0.03, 0.0], None, 60).unwrap();
        assert_eq!((wider.min, wider.last()), (-24, 35));
    }

    #[test]
    fn a_found_range_is_cut_at_the_limit() {
        let range = DisparityRange::inclusive(-9, 40).unwrap();
        let found = FoundRange { range, seen: [-5.0, 36.0], ends: [RangeEnd::Seeds, RangeEnd::CoarseMap] };
        assert_eq!(not_below(&found, -20, 1.0).unwrap(), range);
        assert_eq!(not_below(&found, 0, 0.9).unwrap(), DisparityRange::inclusive(0, 40).unwrap());
        for (least, share) in [(41, 0.0), (0, 0.04)] {
            let error = not_below(&found, least, share).unwrap_err().to_string();
            assert!(error.contains("-5 to 36 px") && error.contains("exchange"), "{error}");
        }
    }
}
