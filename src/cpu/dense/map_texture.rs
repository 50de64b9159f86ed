//! Disparities as a texture holds them, from the definition.

use crate::disparity::{DisparityMap, NONE, NONE_IN_PIXELS, SCALE};

/// Disparities in pixels, [`NONE_IN_PIXELS`] where there is none. Those of up to 2^16 px are exact.
pub fn map_texture(map: &DisparityMap) -> Vec<f32> {
    let pixels = |&d: &i32| if d == NONE { NONE_IN_PIXELS } else { d as f32 / SCALE as f32 };
    map.data().iter().map(pixels).collect()
}
