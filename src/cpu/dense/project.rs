//! Projection of a map to the other view, from the definition.

use crate::{
    dense::View,
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
};

/// The largest of the disparities of `view` that point at each pixel of the other view, at the nearest whole disparity;
/// [`NONE`] without any.
pub fn project(disparities: &DisparityMap, view: View) -> DisparityMap {
    let Size { width, height } = disparities.size();
    let mut projected = Plane::filled((width, height), NONE);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let disparity = disparities.get(x, y);
        let partner = partner(x, disparity, view);
        if disparity != NONE && (0..i64::from(width)).contains(&partner) {
            let held = projected.get(partner as u32, y);
            projected.set(partner as u32, y, held.max(disparity));
        }
    }
    projected
}

/// Column of the partner of a pixel of `view` in column `x`, at the nearest whole disparity.
pub(super) fn partner(x: u32, disparity: i32, view: View) -> i64 {
    let nearest = (i64::from(disparity) + i64::from(SCALE / 2)).div_euclid(SCALE.into());
    i64::from(x) + i64::from(view.direction()) * nearest
}
