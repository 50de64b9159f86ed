//! What block matching compares.

use crate::names::names;

/// The bytes that block matching compares, one per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// Luma, after [`super::DenseConfig::brightness`].
    Luma,
    /// Soft ranks: how much brighter than the pixel ten neighbours are, each by at most 3 grey levels to either side. They
    /// depend on structure and hardly on brightness, so that [`super::DenseConfig::brightness`] has no part in them.
    SoftRank,
}

names!(Compared, "what blocks compare", { Luma => "luma", SoftRank => "soft-rank" });
