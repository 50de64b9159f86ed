//! Recognition of cameras above each other: columns correspond where rows do not.

use glam::Vec2Swizzles;

use super::evidence::{NEEDED, is_majority, is_small};
use crate::{
    image::Size,
    rectify::{Correspondence, fit::RowFit},
};

/// Smallest share of the seeds that agree on columns and not on rows, for cameras above each other: the surfaces in front of
/// and behind the one that rows follow.
const IN_COLUMNS_ALONE: f64 = 0.05;

/// Number of points that agree on columns, if the cameras stand above each other; `rows` is the number of points that agree
/// on rows. Columns must explain at least half of the points that rows do not.
pub(super) fn vertical(points: &[Correspondence], size: Size, rows: usize) -> Option<usize> {
    let all = points.len();
    let least = rows + NEEDED.0.max((IN_COLUMNS_ALONE * all as f64) as usize);
    if least > all {
        return None;
    }
    let transposed = |point: &Correspondence| Correspondence { left: point.left.yx(), right: point.right.yx() };
    let points: Vec<Correspondence> = points.iter().map(transposed).collect();
    let size = Size::new(size.height, size.width);
    let fit = RowFit::new(&points, size)?;
    let columns = fit.agreeing();
    let explained = columns >= least && 2 * (all - columns) <= all - rows;
    (explained && is_majority(columns, all) && is_small(&fit.model, size)).then_some(columns)
}
