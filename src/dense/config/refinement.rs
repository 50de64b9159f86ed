//! The refinement of a map after its checks.

use crate::error::{Result, check_range};

/// A weighted median filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Median {
    /// Radius of the window, (side - 1) / 2, 1 to 4 pixels.
    pub radius: u32,
    /// Falloff of the weights: a neighbour whose luma differs by 2^`halving_bits` weighs half; 31 gives all neighbours
    /// the same weight.
    pub halving_bits: u32,
    /// Whether the filter changes filled pixels only.
    pub holes_only: bool,
}

/// The refinement of a map after its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// Least support: the number of pixels of the 7x7 window, the centre included, whose disparities must lie within 1
    /// px of the centre's for the centre to keep its disparity, 0 to 49.
    pub support: u32,
    /// Number of passes of a 5x5 weighted median before filling, 0 to 100.
    pub medians_before: u32,
    /// Whether holes are filled.
    pub fill: bool,
    /// Whether filled pixels are filtered by a 9x9 weighted median.
    pub median_of_filled: bool,
    /// Number of passes of a 5x5 weighted median over all pixels after filling, 0 to 100; a plain 3x3 median follows.
    pub medians_after: u32,
}

/// The filters of a refinement, in order: support, medians, filling, more medians.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Filters {
    /// See [`Refinement::support`].
    pub(crate) support: u32,
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
        (0..self.medians_before).map(|_| Median { radius: 2, halving_bits: 3, holes_only: false })
    }

    /// The filters after filling.
    pub fn after(&self) -> impl Iterator<Item = Median> + use<> {
        let filled = Median { radius: 4, halving_bits: 3, holes_only: true };
        let all = Median { radius: 2, halving_bits: 3, holes_only: false };
        let plain = Median { radius: 1, halving_bits: 31, holes_only: false };
        let medians_after = (0..self.medians_after).map(move |_| all);
        (self.fill && self.median_of_filled).then_some(filled).into_iter().chain(medians_after).chain([plain])
    }
}
