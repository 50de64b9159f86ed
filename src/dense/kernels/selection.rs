//! Selection of a pixel's disparity, common to SAD and aggregated costs. `shaders/shared/selection.wgsl`.

use crate::{
    dense::config::{FILLED, Interpolation},
    disparity::{NONE, SCALE},
};

/// The result that a view is matched for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultKind {
    /// Sub-pixel disparities that pass the uniqueness check, and confidences.
    Matches,
    /// Whole disparities of all winners: enough for the other view's consistency check.
    Winners,
}

/// Operations per disparity besides sums: the key, the winner's minimum, and three for the rival's.
pub(super) const SELECTION_OPERATIONS: u64 = 5;

/// The constants of `shaders/shared/selection.wgsl`, for keys with `index_bits` bits for the disparity's index.
pub(super) fn selection_constants(
    interpolation: Interpolation,
    kind: ResultKind,
    index_bits: u32,
) -> [(&'static str, i64); 8] {
    const PARABOLA: i64 = 1;
    const EQUIANGULAR: i64 = 2;
    let method = match interpolation {
        Interpolation::None => 0,
        Interpolation::Parabola => PARABOLA,
        Interpolation::Equiangular => EQUIANGULAR,
    };
    [
        ("SHIFT", index_bits.into()),
        ("SCALE", SCALE.into()),
        ("NONE", NONE.into()),
        ("MEASURED", i64::from(FILLED) + 1),
        ("FULL", (kind == ResultKind::Matches).into()),
        ("PARABOLA", PARABOLA),
        ("EQUIANGULAR", EQUIANGULAR),
        ("INTERPOLATION", method),
    ]
}
