//! The matching cost of a pixel and its partner.

/// The largest matching cost: the sum of a cost and a penalty of the same size fits in 8 bits.
pub const MAX_COST: u32 = 127;

/// Fractional bits of a weight.
pub const WEIGHT_BITS: u32 = 4;

/// A truncated absolute difference as part of a cost: `weight / 16 min(|a - b|, limit)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Weight, in 1/16, 0 to 4096.
    pub weight: u32,
    /// Truncation: larger differences count as this one, 0 to 4096 grey levels.
    pub limit: u32,
}

/// The matching cost of a pixel and its partner: the sum of its parts, rounded down and at most 127.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cost {
    /// Weight of each of the 24 bits in which the 5x5 census transforms differ, in 1/16, 0 to 4096.
    pub census: u32,
    /// Truncated difference of luma.
    pub difference: Difference,
    /// Truncated difference of the horizontal gradients of luma; a gradient is the difference of the two neighbours in
    /// the row.
    pub gradient: Difference,
    /// Where the 3x3 lumas around pixels of the reference view have sums that differ by at most this, 0 to 2295 (9 x 255),
    /// texture is weak. There the wide census takes the place of the census, and luma has no part, since it says more about
    /// brightness than about disparity. `None`: no pixel has weak texture.
    ///
    /// Of the 24 bits of the wide census every second one, as on a chessboard, compares the sum of the 3x3 lumas around
    /// the pixel with that around a neighbour twice as far away. The 13 sums are those that must hardly differ.
    pub weak_spread: Option<u32>,
}
