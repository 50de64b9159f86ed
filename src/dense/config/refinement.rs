//! The refinement of a map after its checks.

use crate::error::{Result, check_range};

/// Largest confidence of a filled pixel; that of a measured one is larger.
pub const FILLED: u8 = 15;

/// A weighted median filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Median {
    /// Radius of the window, (side - 1) / 2, 1 to 4 pixels.
    pub radius: u32,
    /// Falloff of the weights: a neighbour whose luma differs by 2^`halving_bits` weighs half; 31 gives all neighbours
    /// the same weight.
    pub halving_bits: u32,
}

/// The refinement of a map after its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// Least support: the number of pixels of the 7x7 window, the centre included, whose disparities must lie within 1
    /// px of the centre's for the centre to keep its disparity, 0 to 49.
    pub support: u32,
    /// Whether at least half of that window, as far as it lies within the picture, must have a disparity that is at most 2 px
    /// larger than the centre's, too: whatever is beside holes, or just behind something nearer, is filled more reliably than
    /// it was measured. Thin things in front of others stay.
    pub majority: bool,
    /// Number of passes of a 5x5 weighted median before filling, 0 to 100.
    pub medians_before: u32,
    /// Whether holes are filled, from the surfaces that rays in eight directions reach, by the colours of the reference view
    /// and by what the other view shows.
    pub fill: bool,
    /// Number of passes of a 5x5 weighted median over all pixels after filling, 0 to 100; a plain 3x3 median follows.
    pub medians_after: u32,
}

/// The filters of a refinement, in order: support, medians, filling, more medians.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Filters {
    /// See [`Refinement::support`].
    pub(crate) support: u32,
    /// See [`Refinement::majority`].
    pub(crate) majority: bool,
    /// The medians before filling.
    pub(crate) before: Vec<Median>,
    /// Whether holes are filled.
    pub(crate) fill: bool,
    /// The medians after filling.
    pub(crate) after: Vec<Median>,
}

impl From<&Refinement> for Filters {
    fn from(refinement: &Refinement) -> Self {
        Self {
            support: refinement.support,
            majority: refinement.majority,
            before: refinement.before().collect(),
            fill: refinement.fill,
            after: refinement.after().collect(),
        }
    }
}

impl Refinement {
    /// Checks that all values lie in their ranges.
    pub(super) fn validate(&self) -> Result<()> {
        check_range("support", self.support, 0..=49)?;
        check_range("medians_before", self.medians_before, 0..=100)?;
        check_range("medians_after", self.medians_after, 0..=100)
    }

    /// The filters before filling.
    pub fn before(&self) -> impl Iterator<Item = Median> + use<> {
        (0..self.medians_before).map(|_| Median { radius: 2, halving_bits: 3 })
    }

    /// The filters after filling.
    pub fn after(&self) -> impl Iterator<Item = Median> + use<> {
        let weighted = Median { radius: 2, halving_bits: 3 };
        let plain = Median { radius: 1, halving_bits: 31 };
        (0..self.medians_after).map(move |_| weighted).chain([plain])
    }
}
