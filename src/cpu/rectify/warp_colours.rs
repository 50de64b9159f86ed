//! Resampling of a picture in colour by a map, from the definition.

use super::warp;
use crate::{image::Plane, io::Picture, rectify::WarpMap};

/// Resamples the red, green and blue of `source` as [`warp`](fn@warp) does; alpha is 255. Pixels that show nothing of the source,
/// [`WarpMap::visible`], are 0.
pub fn warp_colours(source: &Picture, map: &WarpMap) -> Picture {
    let [red, green, blue] = [0, 1, 2].map(|channel| warp(&source.map(|pixel| pixel[channel]), map));
    let visible = map.visible();
    Plane::from_fn(map.size(), |x, y| match visible.get(x, y) {
        0 => [0; 4],
        alpha => [red.get(x, y), green.get(x, y), blue.get(x, y), alpha],
    })
}
