//! Sub-pixel interpolation.

use crate::names::names;

/// Sub-pixel interpolation from the costs c-, c, c+ of the winner c and its two neighbours. Disparities are rounded to
/// the nearest 1/256 px, halves up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Whole pixels, without interpolation.
    None,
    /// The vertex of a parabola: (c- - c+) / 2(c- - 2c + c+).
    Parabola,
    /// The intersection of two lines of opposite slope: (c- - c+) / 2(max(c-, c+) - c). Shimizu and Okutomi: 'Precise sub-pixel
    /// estimation on area-based matching', ICCV 2001: absolute differences have a pointed minimum, which a parabola pulls
    /// to whole pixels.
    #[default]
    Equiangular,
}

names!(Interpolation, "the interpolation", { None => "none", Parabola => "parabola", Equiangular => "equiangular" });
