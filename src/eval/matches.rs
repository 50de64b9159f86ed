//! Quality of point matches against the ground truth.

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

/// A match to be judged: a position in the first view and the matched position in the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMatch {
    /// Position in the first view, in pixels.
    pub first: DVec2,
    /// Position in the second view, in pixels.
    pub second: DVec2,
    /// Confidence, larger for more confident matches; only the order matters.
    pub confidence: f64,
    /// Indices of the matched interest points of the first and the second view, if known.
    pub points: Option<[usize; 2]>,
}

impl From<&WideBaselineMatch> for PointMatch {
    fn from(found: &WideBaselineMatch) -> Self {
        let WideBaselineMatch { first, second, confidence, points } = *found;
        Self { first, second, confidence: confidence.into(), points: Some(points) }
    }
}

/// Matches judged against the ground truth.
///
/// A match is *right* if the second view shows the point of the first, and the matched position lies within the
/// tolerance of the true one. Otherwise it is *wrong*, also if the point is occluded and nothing could be found.
/// Matches without ground truth are neither and do not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// For each match with ground truth, the most confident first: whether it is right. Among equally confident matches
    /// the wrong ones come first, so that ties never help.
    pub right: Vec<bool>,
    /// Number of matches without ground truth.
    pub unknown: usize,
    /// Index of the match of each entry of `right`.
    order: Vec<usize>,
}

impl Judged {
    /// Judges `matches` with a `tolerance` in pixels of the second view, at least 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a tolerance that is negative or NaN, or a confidence that is NaN.
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

    /// Interleaves right and wrong matches of equal confidence evenly, as a random order does on average. For
    /// confidences with few distinct values, which large parts of a picture share. `matches` are those given to
    /// [`Self::new`].
    #[must_use]
    pub fn with_even_ties(mut self, matches: &[PointMatch]) -> Self {
        let mut start = 0;
        let confidence = |index: &usize| matches[*index].confidence;
        for tie in self.order.chunk_by_mut(|a, b| confidence(a) == confidence(b)) {
            let right = &mut self.right[start..start + tie.len()];
            start += tie.len();
            let (count, wrong) = (right.len(), right.iter().filter(|&&right| !right).count());
            let [wrong_ones, right_ones] = [&tie[..wrong], &tie[wrong..]].map(<[usize]>::to_vec);
            // Number of right matches among the first `k`, rounded.
            let share = |k: usize| (2 * k * (count - wrong) + count) / (2 * count);
            for k in 0..count {
                right[k] = share(k + 1) > share(k);
                tie[k] = if right[k] { right_ones[share(k)] } else { wrong_ones[k - share(k)] };
            }
        }
        self
    }

    /// Precision, the share of right matches, 0 to 1; NaN without matches.
    pub fn precision(&self) -> f64 {
        accuracy_of_first(&self.right, self.right.len())
    }

    /// Number of right matches.
    pub fn count_right(&self) -> usize {
        self.right.iter().filter(|&&right| right).count()
    }
}

/// Figures of matches relative to the detected interest points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointScores {
    /// Correspondences between the points.
    pub repeatability: Repeatability,
    /// Number of points that could have been matched: the correspondences (see [`Repeatability`]), and every other
    /// point with a right match, since block matching can locate a point to a pixel and a half where two detections are
    /// further apart.
    pub findable: usize,
    /// Points with a right match, each counted once, divided by `findable`: 0 to 1, NaN if `findable` is 0.
    pub recall: f64,
    /// F-measure, the harmonic mean of precision and recall, 0 to 1.
    pub f_measure: f64,
    /// Share of the first view's points, in the area that both views show, that have a match, right or wrong: 0 to 1.
    pub coverage: f64,
    /// Matches of corresponding points, with an overlap error of at most
    /// [`MAX_OVERLAP_ERROR`](super::MAX_OVERLAP_ERROR), divided by the points in the area that both views show, of the
    /// view with fewer points: 0 to 1.
    pub matching_score: f64,
}

impl PointScores {
    /// Computes the figures of `matches` between the points `first` and `second`. Matches without indices of points can
    /// be right, too.
    pub fn new(matches: &[PointMatch], judged: &Judged, [first, second]: [&[Point]; 2], truth: &Truth) -> Self {
        let repeatability = Repeatability::new(first, second, truth);
        let mut matched = vec![false; first.len()];
        // Points with a right match, and positions of right matches without indices of points, each once.
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
        let disparities = Plane::from_fn((100, 80), |_, y| if y == 79 { f32::INFINITY } else { 10.0 });
        let nonocc = Plane::from_fn((100, 80), |_, y| if y == 78 { 0 } else { 255 });
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
        let point_scores = PointScores::new(&matches, &judged, [&points(40.0), &points(30.0)], &truth());
        assert_eq!((point_scores.findable, point_scores.recall, point_scores.f_measure), (5, 1.0, 1.0));
        assert_eq!(
            (point_scores.coverage, point_scores.matching_score, point_scores.repeatability.share()),
            (1.0, 1.0, 1.0)
        );
    }

    #[test]
    fn no_matches_and_wrong_ones_score_0() {
        let none = Judged::new(&[], &truth(), 1.5).unwrap();
        let point_scores = PointScores::new(&[], &none, [&points(40.0), &points(30.0)], &truth());
        assert!(none.precision().is_nan());
        assert_eq!((point_scores.recall, point_scores.coverage, point_scores.matching_score), (0.0, 0.0, 0.0));

        // Each point matched to the position of the next one.
        let wrong: Vec<_> = (0..4).map(|i| PointMatch { points: Some([i, i + 1]), ..found(i, 12.0, 0.5) }).collect();
        let judged = Judged::new(&wrong, &truth(), 1.5).unwrap();
        let point_scores = PointScores::new(&wrong, &judged, [&points(40.0), &points(30.0)], &truth());
        assert_eq!((judged.precision(), point_scores.recall, point_scores.f_measure), (0.0, 0.0, 0.0));
        assert_eq!((point_scores.findable, point_scores.matching_score, point_scores.coverage), (5, 0.0, 0.8));
    }

    #[test]
    fn figures_agree_with_a_calculation_by_hand() {
        let at =
            |y| PointMatch { first: DVec2::new(50.0, y), second: DVec2::new(40.0, y), confidence: 0.9, points: None };
        let matches = [
            found(0, 1.5, 0.8),  // right, just
            found(1, -1.6, 0.8), // wrong, and first of the two equals
            found(2, 0.0, 0.7),
            at(79.0), // no ground truth
            at(78.0), // occluded
            at(60.0), // right, though no point was found there
        ];
        let judged = Judged::new(&matches, &truth(), 1.5).unwrap();
        assert_eq!(judged.right, [false, true, false, true, true]);
        assert_eq!((judged.unknown, judged.count_right(), judged.precision()), (1, 3, 0.6));
        // The fourth and the fifth point of the second view are 20 px off and correspond to nothing.
        let mut second = points(30.0);
        second[3].at.y += 20.0;
        second[4].at.y += 20.0;
        let point_scores = PointScores::new(&matches, &judged, [&points(40.0), &second], &truth());
        assert_eq!(point_scores.repeatability.correspondences(), 3);
        assert_eq!((point_scores.findable, point_scores.recall), (4, 0.75));
        assert!((point_scores.f_measure - 0.9 / 1.35).abs() < 1e-12);
        assert_eq!((point_scores.coverage, point_scores.matching_score), (0.6, 0.6));
    }

    #[test]
    fn equals_take_turns() {
        // Of four equally confident matches, those of points 1 and 2 are wrong; the fifth match is more confident.
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
        // Among the first 1, 2, 3 and 4 equals, 0.5, 1, 1.5 and 2 are right: 1, 1, 2 and 2 after rounding.
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
        let point_scores = |matches: &[PointMatch], count: usize| {
            PointScores::new(matches, &judged, [&points(40.0)[..count], &points(30.0)], &truth())
        };
        let one = point_scores(&twice, 1);
        assert_eq!((one.findable, one.recall, one.matching_score), (1, 1.0, 1.0));
        let two = point_scores(&twice, 2);
        assert_eq!((two.findable, two.recall, two.matching_score), (2, 0.5, 0.5));
        // Matches without indices of points are not counted twice either.
        let nameless = twice.map(|found| PointMatch { points: None, ..found });
        let two = point_scores(&nameless, 2);
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
