//! A picture of half the size, from the definition.

use crate::image::{Luma, reduced};

/// A picture of half the size, each pixel the rounded mean of four, or of as many as there are at the edges.
pub fn halve(luma: &Luma) -> Luma {
    reduced(luma, 2)
}
