//! Downscaling to half the size, from the definition.

use crate::image::{Luma, reduced};

/// Downscales a picture to half its size: each pixel is the rounded mean of a block of 2x2, cut off at the edges.
pub fn halve(luma: &Luma) -> Luma {
    reduced(luma, 2)
}
