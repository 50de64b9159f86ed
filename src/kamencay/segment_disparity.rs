//! The disparities of segments from the beliefs of pixels, on the host.

use std::collections::BTreeMap;

use super::{
    Segments,
    alikeness::alikeness,
    kernels::Winner,
    surface::{Sample, Surface},
};
use crate::{
    dense::{Dense, FILLED},
    disparity::{DisparityRange, NONE, SCALE},
    image::{Plane, Size},
};

/// Parameters of the disparities of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conclusion {
    /// Left-right consistency: the largest accepted difference from the best claim to a pixel's partner, in pixels; 0
    /// by default.
    pub confirmation: u32,
    /// Least share of confirmed pixels for a segment to have a disparity, 0 to 16 in 1/16; 4 by default.
    pub least_confirmed: u32,
    /// Largest difference of a pixel's disparity from its segment's, in pixels; 4 by default. Pixels beyond take the
    /// segment's disparity.
    pub tolerance: u32,
}

/// The result of a segment's confirmed pixels.
struct Segment {
    /// Surface through their disparities; `None` if too few pixels are confirmed.
    surface: Option<Surface>,
    /// Share of the segment's pixels that are confirmed and near the surface, 0 to 127.
    agreement: u8,
}

/// The map of the left one of two `views`; the disparities of `winners` were searched in `range`.
///
/// The confidence is 0 where the disparity is not the pixel's own, or where another disparity has the same belief;
/// otherwise it is that of [`confidence`].
pub(super) fn conclude(
    winners: &Plane<Winner>,
    segments: &Segments,
    range: DisparityRange,
    conclusion: &Conclusion,
    views: [&Plane<u8>; 2],
) -> Dense {
    let Size { width, height } = winners.size();
    let own = winners.map(|winner| range.min + winner.index() as i32);
    let confirmed = confirmed(winners, &own, conclusion.confirmation);
    let confirmed_at = |x: u32, y: u32| confirmed.get(x, y).then(|| own.get(x, y));

    let labels = segments.labels();
    let tolerance = i64::from(conclusion.tolerance) * i64::from(SCALE);
    let surfaces = segment_surfaces(labels, confirmed_at, conclusion.least_confirmed, tolerance);
    let span = i64::from(range.min * SCALE)..=i64::from(range.last() * SCALE);
    let mut dense =
        Dense { disparity: Plane::filled((width, height), NONE), confidence: Plane::filled((width, height), 0) };
    for y in 0..height {
        let row: Vec<Option<i32>> = (0..width).map(|x| confirmed_at(x, y)).collect();
        let beside = nearest(&row);
        for x in 0..width {
            let segment = &surfaces[&labels.get(x, y)];
            // The disparity of the pixel without its segment.
            let alone = row[x as usize].or(beside[x as usize]).unwrap_or(own.get(x, y));
            match segment.surface.filter(|surface| surface.distance(&(x, y, alone)) > tolerance) {
                Some(surface) => {
                    dense.disparity.set(x, y, surface.at(x, y).clamp(*span.start(), *span.end()) as i32);
                }
                None => {
                    dense.disparity.set(x, y, alone * SCALE);
                    if row[x as usize].is_some() && winners.get(x, y).margin() > 0 {
                        let certainty = certainty(winners.get(x, y).margin());
                        let alike = alikeness(views, (x, y), alone);
                        dense.confidence.set(x, y, confidence(segment.agreement, certainty, alike));
                    }
                }
            }
        }
    }
    dense
}

/// Whether the other view confirms each pixel's winner: among all pixels with the same partner, the one of least belief
/// claims the partner (ties go to the smaller disparity), and the two disparities differ by at most `most` px.
fn confirmed(winners: &Plane<Winner>, own: &Plane<i32>, most: u32) -> Plane<bool> {
    let Size { width, height } = own.size();
    let partner = |x: u32, y: u32| x.checked_add_signed(-own.get(x, y)).filter(|&partner| partner < width);
    let mut claims: Plane<Option<(u32, i32)>> = Plane::filled((width, height), None);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let Some(partner) = partner(x, y) else { continue };
        let claim = (winners.get(x, y).belief(), own.get(x, y));
        if claims.get(partner, y).is_none_or(|held| claim < held) {
            claims.set(partner, y, Some(claim));
        }
    }
    Plane::from_fn((width, height), |x, y| {
        let claim = partner(x, y).and_then(|partner| claims.get(partner, y));
        claim.is_some_and(|(_, disparity)| own.get(x, y).abs_diff(disparity) <= most)
    })
}

/// The confidence of a pixel, above [`FILLED`], from three parts of 0 to 127: the agreement within its segment, the margin of
/// its belief, and the similarity of both views there. No part suffices alone: whole segments can be wrong, beliefs
/// spread across segments, and repeated texture looks similar.
fn confidence(agreement: u8, certainty: u8, alikeness: u8) -> u8 {
    let sum = u32::from(agreement) + u32::from(certainty) + u32::from(alikeness);
    (1 + (2 * sum / 3) as u8).max(FILLED + 1)
}

/// The certainty of a belief, 0 to 127, from its `margin` to the best rival.
fn certainty(margin: u32) -> u8 {
    /// The margin of half certainty: a difference of colours that weighs as much is a large one.
    const HALF: u64 = 64;
    (127 * u64::from(margin) / (u64::from(margin) + HALF)) as u8
}

/// The surface of each segment; pixels within `tolerance`, in 1/256 px, agree with it.
fn segment_surfaces(
    labels: &Plane<u32>,
    confirmed_at: impl Fn(u32, u32) -> Option<i32>,
    least_confirmed: u32,
    tolerance: i64,
) -> BTreeMap<u32, Segment> {
    let mut members: BTreeMap<u32, (usize, Vec<Sample>)> = BTreeMap::new();
    for y in 0..labels.height() {
        for x in 0..labels.width() {
            let (count, samples) = members.entry(labels.get(x, y)).or_default();
            *count += 1;
            samples.extend(confirmed_at(x, y).map(|disparity| (x, y, disparity)));
        }
    }
    let segment = |(label, (count, samples)): (u32, (usize, Vec<Sample>))| {
        let enough = 16 * samples.len() >= least_confirmed as usize * count;
        let surface = Surface::of(&samples).filter(|_| enough);
        let agreeing =
            surface.map_or(0, |surface| samples.iter().filter(|sample| surface.distance(sample) <= tolerance).count());
        (label, Segment { surface, agreement: (127 * agreeing / count) as u8 })
    };
    members.into_iter().map(segment).collect()
}

/// For each pixel of a row, the smaller of the nearest disparities to its left and right: an occluded surface is
/// further away than the one that occludes it.
fn nearest(row: &[Option<i32>]) -> Vec<Option<i32>> {
    let last_seen = |last: &mut Option<i32>, disparity: &Option<i32>| {
        *last = disparity.or(*last);
        Some(*last)
    };
    let left: Vec<_> = row.iter().scan(None, last_seen).collect();
    let mut right: Vec<_> = row.iter().rev().scan(None, last_seen).collect();
    right.reverse();
    left.into_iter().zip(right).map(|(left, right)| left.into_iter().chain(right).min()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kamencay::Segmentation;

    #[test]
    fn holes_take_the_smaller_of_their_neighbours() {
        let row = [None, Some(5), None, None, Some(3), None];
        assert_eq!(nearest(&row), [Some(5), Some(5), Some(3), Some(3), Some(3), Some(3)]);
        assert_eq!(nearest(&[None, None]), [None, None]);
    }

    #[test]
    fn a_segment_overrules_what_is_far_from_it() {
        // One segment of seven pixels; the fifth claims the partner of the first with a worse belief.
        let winner = |disparity, belief| Winner::new(disparity, belief, Some(belief + 50));
        let row = [(0, 5), (0, 5), (1, 5), (0, 5), (4, 9), (0, 5), (3, 5)].map(|(d, b)| winner(d, b)).to_vec();
        let winners = Plane::new((7, 1), row).unwrap();
        let segments = Segments::new(&Plane::filled((7, 1), 0), Segmentation { join: 0, least: 0 });
        let range = DisparityRange::new(0, 8).unwrap();
        // Only windows whose partner is at disparity 0 are similar.
        let view = Plane::from_fn((7, 1), |x, _| (9 * x * x) as u8);
        let flat = Plane::filled((7, 1), 0);
        let conclude = |tolerance, other| {
            let conclusion = Conclusion { confirmation: 0, least_confirmed: 2, tolerance };
            conclude(&winners, &segments, range, &conclusion, [&view, other])
        };
        // Partners: 0, 1, 1, 3, 0, 5, 3; a tie goes to the smaller disparity. Four zeros are confirmed.
        for (other, alike) in [(&flat, 0), (&view, 127)] {
            let dense = conclude(0, other);
            assert_eq!(dense.disparity.data(), [0; 7]);
            // Four of seven pixels agree; certainty 50 / (50 + 64).
            let expected = 1 + (2 * (127 * 4 / 7 + 127 * 50 / 114 + alike) / 3) as u8;
            assert_eq!(dense.confidence.data(), [expected, expected, 0, expected, 0, expected, 0]);
        }
        let loose = Conclusion { confirmation: 1, least_confirmed: 2, tolerance: 1 };
        let dense = super::conclude(&winners, &segments, range, &loose, [&view, &flat]);
        assert_eq!(dense.disparity.data(), [0, 0, 256, 0, 0, 0, 0]);
    }

    #[test]
    fn what_is_as_good_elsewhere_is_not_measured() {
        // Three confirmed pixels; another disparity is as good for the second.
        let winners = [Some(7), Some(5), None].map(|rival| Winner::new(0, 5, rival)).to_vec();
        let segments = Segments::new(&Plane::filled((3, 1), 0), Segmentation { join: 0, least: 0 });
        let conclusion = Conclusion { confirmation: 0, least_confirmed: 2, tolerance: 0 };
        let (winners, flat) = (Plane::new((3, 1), winners).unwrap(), Plane::filled((3, 1), 0));
        let dense = conclude(&winners, &segments, DisparityRange::new(0, 8).unwrap(), &conclusion, [&flat, &flat]);
        assert_eq!(dense.disparity.data(), [0; 3]);
        assert_eq!(dense.confidence.map(|&confidence| confidence > 0).data(), [true, false, true]);
    }

    #[test]
    fn without_enough_confirmed_pixels_a_segment_has_no_disparity() {
        // Both claim pixels outside: nothing is confirmed, and all stay with what they believe.
        let winners = Plane::filled((2, 1), Winner::new(3, 0, None));
        let segments = Segments::new(&Plane::filled((2, 1), 0), Segmentation { join: 0, least: 0 });
        let conclusion = Conclusion { confirmation: 1, least_confirmed: 1, tolerance: 0 };
        let (range, flat) = (DisparityRange::new(-1, 8).unwrap(), Plane::filled((2, 1), 0));
        let dense = conclude(&winners, &segments, range, &conclusion, [&flat, &flat]);
        // A disparity of -1 + 3.
        assert_eq!((dense.disparity.data(), dense.confidence.data()), (&[512, 512][..], &[0, 0][..]));
    }
}
