//! Row errors of matched points after a rectification.

/// Row error of a point that counts as a right match, in pixels of the detection.
const RIGHT: f64 = 3.0;

/// Row errors of matched points, in pixels of the rectified pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Number of the points, and of those whose rows differ by at most 3 px at the size at which points were detected; the
    /// others are wrong matches and not part of the figures below.
    pub points: usize,
    /// See `points`.
    pub right: usize,
    /// Mean of the row errors.
    pub mean: f64,
    /// 95 % of the row errors are at most this.
    pub most: f64,
}

impl Residual {
    /// The residual of `points` matches, of which those that appear in both pictures have these row errors, in pixels; the pictures were
    /// reduced by `factor` before points were detected.
    pub(crate) fn new(points: usize, errors: impl Iterator<Item = f64>, factor: f64) -> Self {
        let mut errors: Vec<f64> = errors.map(f64::abs).filter(|&error| error <= RIGHT * factor).collect();
        errors.sort_by(f64::total_cmp);
        let right = errors.len();
        let mean = errors.iter().sum::<f64>() / right.max(1) as f64;
        let most = errors.get(right * 95 / 100).copied().unwrap_or(0.0);
        Self { points, right, mean, most }
    }

    /// Whether most matches are right.
    pub fn is_of_most(&self) -> bool {
        2 * self.right >= self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_by_hand() {
        let errors = [0.5, -1.0, 6.0, -6.5, 0.0];
        let of = |factor| Residual::new(6, errors.into_iter(), factor);
        assert_eq!(of(1.0), Residual { points: 6, right: 3, mean: 0.5, most: 1.0 });
        assert_eq!(of(2.0), Residual { points: 6, right: 4, mean: 1.875, most: 6.0 });
        assert!(of(1.0).is_of_most() && !Residual { right: 2, ..of(1.0) }.is_of_most());
        assert_eq!(Residual::new(0, [].into_iter(), 1.0), Residual { points: 0, right: 0, mean: 0.0, most: 0.0 });
    }
}
