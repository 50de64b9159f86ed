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
    /// The cost of pixels of the reference view with weak texture; `None`: as that of other pixels.
    pub weak: Option<WeakTexture>,
}

/// The matching cost where the reference view has weak texture: census, wide census and the gradient as elsewhere, without
/// luma, which says more about brightness there than about disparity.
///
/// The wide census compares the sum of the 3x3 lumas around a pixel with those around 5x5 pixels at a distance of two
/// columns and two rows. Texture is weak where these 25 sums hardly differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WeakTexture {
    /// Largest difference of the sums of weak texture, 0 to 2295 (9 x 255).
    pub spread: u32,
    /// Weight of each of the 24 bits in which the census transforms differ, in 1/16, 0 to 4096.
    pub census: u32,
    /// Weight of each of the 24 bits in which the wide census transforms differ, in 1/16, 0 to 4096.
    pub wide_census: u32,
}
