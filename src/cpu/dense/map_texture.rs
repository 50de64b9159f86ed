//! Disparities in pixels, as texels, from the definition.

use crate::disparity::{DisparityMap, NONE, NONE_IN_PIXELS, SCALE};

/// Converts disparities to pixels, [`NONE`] to [`NONE_IN_PIXELS`]. Disparities up to 2^16 px are exact.
pub fn map_texture(map: &DisparityMap) -> Vec<f32> {
    let pixels = |&d: &i32| if d == NONE { NONE_IN_PIXELS } else { d as f32 / SCALE as f32 };
    map.data().iter().map(pixels).collect()
}
