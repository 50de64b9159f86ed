//! Curves over matches in order of confidence: the paper's figures 7 to 9, and precision over coverage.
//!
//! Each curve is computed from a list with `true` for a right match and `false` for a wrong one, the most confident
//! first: these are the matches that a falling confidence threshold accepts. The `i`-th value belongs to the first `i +
//! 1` matches.

/// Recall and precision of the matches above a confidence threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecallPrecision {
    /// Right matches divided by all correspondences, 0 to 1.
    pub recall: f64,
    /// Right matches divided by matches, 0 to 1.
    pub precision: f64,
}

impl RecallPrecision {
    /// F-measure, the harmonic mean of recall and precision, 0 to 1; 0 if both are 0.
    pub fn f_measure(&self) -> f64 {
        f_measure(self.precision, self.recall)
    }
}

/// F-measure, the harmonic mean of precision and recall, 0 to 1; 0 if both are 0.
pub fn f_measure(precision: f64, recall: f64) -> f64 {
    if precision + recall == 0.0 { 0.0 } else { 2.0 * precision * recall / (precision + recall) }
}

/// Recall and precision (figure 7) of the first 1, 2, 3... matches; `correspondences` is the number of matches that
/// could be found, at least the number of right ones.
pub fn recall_precision(right: &[bool], correspondences: usize) -> Vec<RecallPrecision> {
    let each = (1..).zip(counts(right));
    each.map(|(k, right)| RecallPrecision { recall: share(right, correspondences), precision: share(right, k) })
        .collect()
}

/// Recall and F-measure (figure 8) of the first 1, 2, 3... matches.
pub fn f_measure_over_recall(right: &[bool], correspondences: usize) -> Vec<(f64, f64)> {
    recall_precision(right, correspondences).iter().map(|point| (point.recall, point.f_measure())).collect()
}

/// Accuracy (figure 9): share of right matches among the first `k`, or among all if there are fewer; NaN without
/// matches.
pub fn accuracy_of_first(right: &[bool], k: usize) -> f64 {
    let first = &right[..right.len().min(k)];
    share(first.iter().filter(|&&right| right).count(), first.len())
}

/// Coverage and precision of the first 1, 2, 3... matches, 0 to 1: matches divided by `all` points or pixels of the
/// reference view with known ground truth, and right matches divided by matches.
pub fn precision_over_coverage(right: &[bool], all: usize) -> Vec<(f64, f64)> {
    (1..).zip(counts(right)).map(|(k, right)| (share(k, all), share(right, k))).collect()
}

/// Number of right matches among the first 1, 2, 3...
fn counts(right: &[bool]) -> impl Iterator<Item = usize> {
    right.iter().scan(0, |count, &right| {
        *count += usize::from(right);
        Some(*count)
    })
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT: [bool; 4] = [true, true, false, true];

    #[test]
    fn by_hand() {
        let point = |recall, precision| RecallPrecision { recall, precision };
        let expected = [point(0.2, 1.0), point(0.4, 1.0), point(0.4, 2.0 / 3.0), point(0.6, 0.75)];
        assert_eq!(recall_precision(&RIGHT, 5), expected);
        let f = f_measure_over_recall(&RIGHT, 5);
        // 2 * 0.6 * 0.75 / 1.35
        assert!((f[3].1 - 0.9 / 1.35).abs() < 1e-12 && f[3].0 == 0.6 && f.len() == 4);
        assert_eq!(precision_over_coverage(&RIGHT, 8)[2..], [(0.375, 2.0 / 3.0), (0.5, 0.75)]);
    }

    #[test]
    fn accuracy_of_the_first() {
        assert_eq!([1, 2, 3, 4, 100].map(|k| accuracy_of_first(&RIGHT, k)), [1.0, 1.0, 2.0 / 3.0, 0.75, 0.75]);
        assert!(accuracy_of_first(&[], 10).is_nan());
    }

    #[test]
    fn only_wrong_and_only_right_ones() {
        assert!(
            recall_precision(&[false; 3], 9)
                .iter()
                .all(|p| p.recall == 0.0 && p.precision == 0.0 && p.f_measure() == 0.0)
        );
        let last = *recall_precision(&[true; 3], 3).last().unwrap();
        assert_eq!((last.recall, last.precision, last.f_measure()), (1.0, 1.0, 1.0));
    }
}
