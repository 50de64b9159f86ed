//! What is done with a map after its checks.

/// A weighted median filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Median {
    /// Half its window without the centre, 1 to 4.
    pub radius: u32,
    /// A neighbour whose luma differs by 2 to the power of this weighs half; 31: all weigh the same.
    pub halving_bits: u32,
    /// Whether only pixels that were filled change.
    pub holes_only: bool,
}

/// What is done with a map after its checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refinement {
    /// How many pixels of the 7x7 around one must have its disparity within a pixel, itself included, for it to
    /// stay; 0 to 49.
    pub support: u32,
    /// How often what stays is filtered by a 5x5 weighted median.
    pub medians_before: u32,
    /// Whether holes are filled.
    pub fill: bool,
    /// Whether what was filled is filtered by a 9x9 weighted median of its own.
    pub median_of_filled: bool,
    /// How often all is filtered by a 5x5 weighted median, before a plain one of 3x3.
    pub medians_after: u32,
}

impl Refinement {
    /// The filters before holes are filled.
    pub fn before(&self) -> impl Iterator<Item = Median> + use<> {
        (0..self.medians_before).map(|_| Median { radius: 2, halving_bits: 3, holes_only: false })
    }

    /// The filters after that.
    pub fn after(&self) -> impl Iterator<Item = Median> + use<> {
        let filled = Median { radius: 4, halving_bits: 3, holes_only: true };
        let all = Median { radius: 2, halving_bits: 3, holes_only: false };
        let plain = Median { radius: 1, halving_bits: 31, holes_only: false };
        let medians_after = (0..self.medians_after).map(move |_| all);
        (self.fill && self.median_of_filled).then_some(filled).into_iter().chain(medians_after).chain([plain])
    }
}
