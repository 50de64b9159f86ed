//! What both ways of matching answer a pixel with. `shaders/shared/selection.wgsl`.

use crate::{
    dense::config::Interpolation,
    disparity::{NONE, SCALE},
};

/// What is wanted of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultKind {
    /// Sub-pixel disparities that pass the uniqueness check, and confidences.
    Matches,
    /// Whole disparities of all winners: enough for the other view's consistency check.
    Winners,
}

/// The constants of `shaders/shared/selection.wgsl`, for keys with so many bits for the disparity's index.
pub(super) fn selection_constants(
    interpolation: Interpolation,
    wanted: ResultKind,
    index_bits: u32,
) -> [(&'static str, i64); 7] {
    const PARABOLA: i64 = 1;
    const EQUIANGULAR: i64 = 2;
    let chosen = match interpolation {
        Interpolation::None => 0,
        Interpolation::Parabola => PARABOLA,
        Interpolation::Equiangular => EQUIANGULAR,
    };
    [
        ("SHIFT", index_bits.into()),
        ("SCALE", SCALE.into()),
        ("NONE", NONE.into()),
        ("FULL", (wanted == ResultKind::Matches).into()),
        ("PARABOLA", PARABOLA),
        ("EQUIANGULAR", EQUIANGULAR),
        ("INTERPOLATION", chosen),
    ]
}
