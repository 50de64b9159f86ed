//! Resampling by a map, from the definition.

use glam::IVec2;

use crate::{
    image::Luma,
    rectify::{SUBPIXEL_BITS, WarpMap, weights},
};

/// Resamples `source`, of the map's source size: each pixel is interpolated at its position by Catmull-Rom splines along x
/// and y (Keys 1981, a = -1/2), rounded to the nearest, halves up, and clamped to 0 to 255. Pixels beyond the source's edge
/// have the luma of the edge; a pixel without a position is 0.
pub fn warp(source: &Luma, map: &WarpMap) -> Luma {
    debug_assert_eq!(source.size(), map.source_size());
    Luma::from_fn(map.size(), |x, y| map.source_at(x, y).map_or(0, |position| interpolated(source, position)))
}

fn interpolated(source: &Luma, position: IVec2) -> u8 {
    let pixel = position >> SUBPIXEL_BITS;
    let [across, down] = (position - (pixel << SUBPIXEL_BITS)).to_array().map(weights);
    let mut sum = 0;
    for (j, weight_y) in (-1..).zip(down) {
        for (i, weight_x) in (-1..).zip(across) {
            let luma = source.get_clamped((pixel.x + i).into(), (pixel.y + j).into());
            sum += weight_x * weight_y * i32::from(luma);
        }
    }
    let half = 1 << (2 * SUBPIXEL_BITS - 1);
    ((sum + half) >> (2 * SUBPIXEL_BITS)).clamp(0, 255) as u8
}
