//! When a fit of rows counts: how many points have to agree with it, and how far a warp of rows reaches.

use crate::{image::Size, rectify::RowModel};

/// Smallest number of inliers, and their smallest share of all seeds. By chance about one seed in a hundred is an
/// inlier.
pub(super) const NEEDED: (usize, f64) = (15, 0.2);
/// Largest rotation that a warp of rows alone removes, in degrees: it shears disparities by 9 % of the height.
pub(super) const TURN: f32 = 5.0;
/// Largest vertical scale that a warp of rows alone removes, and its inverse: windows of 11 columns differ by a column.
const SCALE: f32 = 1.1;
/// Largest row difference that a warp of rows alone removes, as a share of the height: so much of the picture may be lost.
const ROWS: f64 = 0.1;

/// Whether enough points agree with a fit for its figures.
pub(super) fn is_enough(agreeing: usize, seeds: usize) -> bool {
    agreeing >= NEEDED.0 && agreeing as f64 >= NEEDED.1 * seeds as f64
}

/// Whether most points agree with a fit.
pub(super) fn is_majority(agreeing: usize, seeds: usize) -> bool {
    agreeing >= NEEDED.0 && 2 * agreeing >= seeds
}

/// Whether a warp by rows alone mends the rows.
pub(super) fn is_small(model: &RowModel, size: Size) -> bool {
    let turned = model.rotation().abs() > TURN.into();
    !turned && is_of_one_scale(model) && model.largest(size) <= ROWS * f64::from(size.height)
}

/// Whether a warp of rows alone bridges the scale.
pub(super) fn is_of_one_scale(model: &RowModel) -> bool {
    (1.0 / SCALE..=SCALE).contains(&(model.scale() as f32))
}
