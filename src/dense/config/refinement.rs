//! The refinement of a map after its checks.

/// A weighted median filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Median {
    /// Half the window without its centre, 1 to 4 pixels.
    pub radius: u32,
    /// A neighbour whose luma differs by 2^`halving_bits` weighs half; with 31 all neighbours weigh the same.
    pub halving_bits: u32,
    /// Whether only pixels that were filled change.
    pub holes_only: bool,
}

/// The refinement of a map after its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// The pixels of the 7x7 window around a pixel, itself included, whose disparities must lie within 1 px of the pixel's
    /// for the pixel to keep its disparity: 0 to 49.
    pub support: u32,
    /// Passes of a 5x5 weighted median before filling.
    pub medians_before: u32,
    /// Whether holes are filled.
    pub fill: bool,
    /// Whether filled pixels are filtered by a 9x9 weighted median.
    pub median_of_filled: bool,
    /// Passes of a 5x5 weighted median over all pixels after filling, before a plain 3x3 median.
    pub medians_after: u32,
}

impl Refinement {
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
