//! Numbers of points, from the definition.

use crate::dense::{Dense, kernels::PointRule};

/// Whether a pixel of a map is a point.
pub(super) fn is_point(dense: &Dense, rule: PointRule, x: u32, y: u32) -> bool {
    dense.disparity.get(x, y) >= rule.least && dense.confidence.get(x, y) >= rule.min_confidence
}

/// The number of points of each row.
pub fn point_counts(dense: &Dense, rule: PointRule) -> Vec<u32> {
    let (width, height) = (dense.disparity.width(), dense.disparity.height());
    (0..height).map(|y| (0..width).filter(|&x| is_point(dense, rule, x, y)).count() as u32).collect()
}
