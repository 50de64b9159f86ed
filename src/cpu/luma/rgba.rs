//! Luma to RGBA8, from the definition.

use crate::image::{Luma, Plane};

/// The grey picture of a luma, with an alpha of 255.
pub fn rgba(luma: &Luma) -> Plane<[u8; 4]> {
    luma.map(|&grey| [grey, grey, grey, 255])
}
