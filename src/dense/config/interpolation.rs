//! Sub-pixel interpolation.

use crate::names::names;

/// How a disparity is placed between whole pixels, from the costs of the winner and its two neighbours c-, c, c+; always
/// rounded to the nearest 1/256 px, halves up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Whole pixels.
    None,
    /// The vertex of a parabola: (c- - c+) / 2(c- - 2c + c+).
    Parabola,
    /// The tip of two lines of equal slope: (c- - c+) / 2(max(c-, c+) - c). Shimizu and Okutomi: 'Precise sub-pixel
    /// estimation on area-based matching', ICCV 2001: absolute differences have a pointed minimum, which a parabola pulls
    /// to whole pixels.
    #[default]
    Equiangular,
}

names!(Interpolation, "the interpolation", { None => "none", Parabola => "parabola", Equiangular => "equiangular" });
