//! Confidences of a map as texels, from the definition.

use crate::image::Plane;

/// The confidence of each pixel.
pub fn confidence_texture(confidences: &Plane<u8>) -> Vec<u32> {
    confidences.data().iter().map(|&confidence| confidence.into()).collect()
}
