//! How good matches of points are.

use std::collections::BTreeSet;

use glam::DVec2;

use super::{
    curves::{accuracy_of_first, f_measure},
    repeatability::{Point, Repeatability, corresponding},
    truth::Truth,
};
use crate::{
    error::{Error, Result},
    wide_baseline::WideBaselineMatch,
};

/// A point of the first view and where the second is said to show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMatch {
    /// Place in the first view, in pixels.
    pub first: DVec2,
    /// Place in the second view, in pixels.
    pub second: DVec2,
    /// The greater the surer; only its order matters.
    pub confidence: f64,
    /// The indices of the interest points that it comes from, where they are known.
    pub points: Option<[usize; 2]>,
}

impl From<&WideBaselineMatch> for PointMatch {
    fn from(found: &WideBaselineMatch) -> Self {
        let WideBaselineMatch { first, second, confidence, points } = *found;
        Self { first, second, confidence: confidence.into(), points: Some(points) }
    }
}

/// Matches held against the truth.
///
/// A match is *right* if the second view shows the point of the first, and within the tolerance of the place that is
/// named; it is *wrong* if not, also where there is nothing to be found because the point is hidden. Where the truth is
/// not known it is neither and plays no part.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Right or wrong, the most confident first; of equally confident ones the wrong ones first, so that nothing is
    /// gained by a tie.
    pub right: Vec<bool>,
    /// Matches whose truth is not known.
    pub unknown: usize,
    /// The indices of the matches in `right`.
    order: Vec<usize>,
}

impl Judged {
    /// Compares places with a `tolerance` in pixels of the second view.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tolerance or a confidence that is none.
    pub fn new(matches: &[PointMatch], truth: &Truth, tolerance: f64) -> Result<Self> {
        let bad = |name, value: f64, expected: &str| {
            Err(Error::Parameter { name, value: value.to_string(), expected: expected.into() })
        };
        if tolerance.is_nan() || tolerance < 0.0 {
            return bad("tolerance", tolerance, "it must be a number of pixels from 0 up");
        }
        if let Some(found) = matches.iter().find(|found| found.confidence.is_nan()) {
            return bad("a confidence", found.confidence, "it must be a number");
        }
        let is_right = |found: &PointMatch| {
            let place = truth.locate(found.first)?;
            Some(truth.shows(found.first) && (found.second - place).length() <= tolerance)
        };
        let mut judged: Vec<(usize, bool)> =
            (0..matches.len()).filter_map(|i| Some((i, is_right(&matches[i])?))).collect();
        judged.sort_by(|a, b| matches[b.0].confidence.total_cmp(&matches[a.0].confidence).then(a.1.cmp(&b.1)));
        let (order, right): (Vec<_>, Vec<_>) = judged.into_iter().unzip();
        Ok(Self { unknown: matches.len() - right.len(), right, order })
    }

    /// The same, but of equally confident `matches` right and wrong ones take turns evenly, as they do on the average in a
    /// random order: for confidences of a few values, which whole parts of a picture share.
    #[must_use]
    pub fn with_even_ties(mut self, matches: &[PointMatch]) -> Self {
        let mut start = 0;
        let confidence = |index: &usize| matches[*index].confidence;
        for tie in self.order.chunk_by_mut(|a, b| confidence(a) == confidence(b)) {
            let right = &mut self.right[start..start + tie.len()];
            start += tie.len();
            let (count, wrong) = (right.len(), right.iter().filter(|&&right| !right).count());
            let [wrong_ones, right_ones] = [&tie[..wrong], &tie[wrong..]].map(<[usize]>::to_vec);
            // How many of the first `k` are right, rounded.
            let share = |k: usize| (2 * k * (count - wrong) + count) / (2 * count);
            for k in 0..count {
                right[k] = share(k + 1) > share(k);
                tie[k] = if right[k] { right_ones[share(k)] } else { wrong_ones[k - share(k)] };
            }
        }
        self
    }

    /// The share of right ones, 0 to 1; NaN without matches.
    pub fn precision(&self) -> f64 {
        accuracy_of_first(&self.right, self.right.len())
    }

    /// Right matches.
    pub fn count_right(&self) -> usize {
        self.right.iter().filter(|&&right| right).count()
    }
}

/// What matches make of the points that were found.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPoints {
    /// Which points correspond.
    pub repeatability: Repeatability,
    /// What could have been found: the correspondences (see [`Repeatability`]), and any other point with a right match.
    /// A window can find to a pixel and a half what two detections are further off.
    pub findable: usize,
    /// Points with a right match by `findable`, 0 to 1, each counted once; NaN where there is nothing to be found.
    pub recall: f64,
    /// The harmonic mean of precision and recall, 0 to 1.
    pub f_measure: f64,
    /// The share of the first view's points in what both views show that have a match, right or wrong: 0 to 1.
    pub coverage: f64,
    /// Matches of two points that correspond, their overlap error at most
    /// [`MAX_OVERLAP_ERROR`](super::MAX_OVERLAP_ERROR), by the points in what both views show, of the view that has
    /// fewer: 0 to 1.
    pub matching_score: f64,
}

impl OfPoints {
    /// Of `matches` between the points `first` and `second`. Those that name no points can be right all the same.
    pub fn new(matches: &[PointMatch], judged: &Judged, [first, second]: [&[Point]; 2], truth: &Truth) -> Self {
        let repeatability = Repeatability::new(first, second, truth);
        let mut matched = vec![false; first.len()];
        // Points with a right match, and places of right matches that name no points: once each.
        let mut found = vec![false; first.len()];
        let mut elsewhere = BTreeSet::new();
        let mut overlapping = 0;
        for (&index, &right) in judged.order.iter().zip(&judged.right) {
            let points = matches[index].points;
            if let Some([i, j]) = points {
                overlapping += usize::from(
                    !matched[i]
                        && truth.shows(first[i].at)
                        && truth.is_shared(second[j].at)
                        && corresponding(first[i], second[j], truth).is_some(),
                );
                matched[i] = true;
            }
            match points {
                _ if !right => {}
                Some([i, _]) => found[i] = true,
                None => {
                    elsewhere.insert(matches[index].first.to_array().map(f64::to_bits));
                }
            }
        }
        let others = (0..first.len()).filter(|&i| found[i] && repeatability.partner[i].is_none()).count();
        let findable = repeatability.correspondences() + others + elsewhere.len();
        let right = found.iter().filter(|&&found| found).count() + elsewhere.len();
        let recall = right as f64 / findable as f64;
        let answered = (0..first.len()).filter(|&i| matched[i] && truth.shows(first[i].at)).count();
        Self {
            findable,
            recall,
            f_measure: f_measure(judged.precision(), recall),
            coverage: answered as f64 / repeatability.shared[0] as f64,
            matching_score: overlapping as f64 / repeatability.fewer() as f64,
            repeatability,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;

    fn truth() -> Truth {
        let disparities = Plane::from_fn(100, 80, |_, y| if y == 79 { f32::INFINITY } else { 10.0 });
        let nonocc = Plane::from_fn(100, 80, |_, y| if y == 78 { 0 } else { 255 });
        Truth::stereo(disparities, Some(&nonocc)).unwrap()
    }

    fn points(x: f64) -> Vec<Point> {
        (0..5).map(|i| Point { at: DVec2::new(x + 12.0 * f64::from(i), 30.0), scale: 2.0 }).collect()
    }

    fn found(i: usize, offset: f64, confidence: f64) -> PointMatch {
        let at = points(40.0)[i].at;
        PointMatch { first: at, second: at - DVec2::new(10.0 - offset, 0.0), confidence, points: Some([i, i]) }
    }

    #[test]
    fn perfect_matches_score_1() {
        let matches: Vec<_> = (0..5).map(|i| found(i, 0.0, 0.5)).collect();
        let judged = Judged::new(&matches, &truth(), 0.0).unwrap();
        assert_eq!((judged.right.clone(), judged.precision()), (vec![true; 5], 1.0));
        let of_points = OfPoints::new(&matches, &judged, [&points(40.0), &points(30.0)], &truth());
        assert_eq!((of_points.findable, of_points.recall, of_points.f_measure), (5, 1.0, 1.0));
        assert_eq!((of_points.coverage, of_points.matching_score, of_points.repeatability.share()), (1.0, 1.0, 1.0));
    }

    #[test]
    fn no_matches_and_wrong_ones_score_0() {
        let none = Judged::new(&[], &truth(), 1.5).unwrap();
        let of_points = OfPoints::new(&[], &none, [&points(40.0), &points(30.0)], &truth());
        assert!(none.precision().is_nan());
        assert_eq!((of_points.recall, of_points.coverage, of_points.matching_score), (0.0, 0.0, 0.0));

        // Each to the next point's place.
        let wrong: Vec<_> = (0..4).map(|i| PointMatch { points: Some([i, i + 1]), ..found(i, 12.0, 0.5) }).collect();
        let judged = Judged::new(&wrong, &truth(), 1.5).unwrap();
        let of_points = OfPoints::new(&wrong, &judged, [&points(40.0), &points(30.0)], &truth());
        assert_eq!((judged.precision(), of_points.recall, of_points.f_measure), (0.0, 0.0, 0.0));
        assert_eq!((of_points.findable, of_points.matching_score, of_points.coverage), (5, 0.0, 0.8));
    }

    #[test]
    fn figures_agree_with_a_calculation_by_hand() {
        let at =
            |y| PointMatch { first: DVec2::new(50.0, y), second: DVec2::new(40.0, y), confidence: 0.9, points: None };
        let matches = [
            found(0, 1.5, 0.8),  // right, just
            found(1, -1.6, 0.8), // wrong, and first of the two equals
            found(2, 0.0, 0.7),
            at(79.0), // not known
            at(78.0), // hidden
            at(60.0), // right, though no point was found there
        ];
        let judged = Judged::new(&matches, &truth(), 1.5).unwrap();
        assert_eq!(judged.right, [false, true, false, true, true]);
        assert_eq!((judged.unknown, judged.count_right(), judged.precision()), (1, 3, 0.6));
        // The fourth and fifth points of the second view lie 20 px off: they correspond to nothing.
        let mut second = points(30.0);
        second[3].at.y += 20.0;
        second[4].at.y += 20.0;
        let of_points = OfPoints::new(&matches, &judged, [&points(40.0), &second], &truth());
        assert_eq!(of_points.repeatability.correspondences(), 3);
        assert_eq!((of_points.findable, of_points.recall), (4, 0.75));
        assert!((of_points.f_measure - 0.9 / 1.35).abs() < 1e-12);
        assert_eq!((of_points.coverage, of_points.matching_score), (0.6, 0.6));
    }

    #[test]
    fn equals_take_turns() {
        // Of the first view's points 1 and 2 are wrong, of four equals; the fifth is surer.
        let matches = [0.0, 9.0, -9.0, 0.0, 0.0]
            .iter()
            .enumerate()
            .map(|(i, &offset)| found(i, offset, if i == 4 { 0.9 } else { 0.5 }));
        let matches: Vec<_> = matches.collect();
        let judged = Judged::new(&matches, &truth(), 1.5).unwrap();
        assert_eq!(
            (judged.right.clone(), judged.order.clone()),
            (vec![true, false, false, true, true], vec![4, 1, 2, 0, 3])
        );
        // Of the first 1, 2, 3 and 4 equals 0.5, 1, 1.5 and 2 are right: rounded 1, 1, 2 and 2.
        let even = judged.with_even_ties(&matches);
        assert_eq!(
            (even.right.clone(), even.order.clone()),
            (vec![true, true, false, true, false], vec![4, 0, 1, 3, 2])
        );
    }

    #[test]
    fn a_point_is_found_once() {
        let twice = [found(0, 0.0, 0.9), found(0, 0.5, 0.8)];
        let judged = Judged::new(&twice, &truth(), 1.5).unwrap();
        let of_points = |matches: &[PointMatch], count: usize| {
            OfPoints::new(matches, &judged, [&points(40.0)[..count], &points(30.0)], &truth())
        };
        let one = of_points(&twice, 1);
        assert_eq!((one.findable, one.recall, one.matching_score), (1, 1.0, 1.0));
        let two = of_points(&twice, 2);
        assert_eq!((two.findable, two.recall, two.matching_score), (2, 0.5, 0.5));
        // Neither do matches of no point count again.
        let nameless = twice.map(|found| PointMatch { points: None, ..found });
        let two = of_points(&nameless, 2);
        assert_eq!((two.findable, two.recall), (3, 1.0 / 3.0));
    }

    #[test]
    fn nonsense_is_named() {
        let message = |confidence, tolerance| {
            Judged::new(&[found(0, 0.0, confidence)], &truth(), tolerance).unwrap_err().to_string()
        };
        assert!(message(f64::NAN, 1.0).contains("a confidence is NaN"));
        assert!(message(1.0, -1.0).contains("tolerance is -1"));
    }
}
