//! What pixels are compared by.

/// The largest cost: with a penalty of as much it still fits in eight bits.
pub const MAX_COST: u32 = 127;

/// The bits of a weight that stand behind the point.
pub const WEIGHT_BITS: u32 = 4;

/// A difference of two numbers as part of a cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// In 1/16.
    pub weight: u32,
    /// Larger ones count as this.
    pub limit: u32,
}

/// What a pixel and its partner are compared by: the sum of three parts, rounded down and at most
/// [`MAX_COST`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// The weight of each of the 24 bits in which their census transforms differ, in 1/16.
    pub census: u32,
    /// Of their lumas.
    pub difference: Difference,
    /// Of their lumas' gradients along the row, each the difference of the two neighbours.
    pub gradient: Difference,
}
