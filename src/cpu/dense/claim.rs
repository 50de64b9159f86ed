//! The other view's disparities, claimed by the winners of one view, from the definition.

use crate::{
    dense::View,
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
};

/// The disparity of each pixel of the other view: that of the cheapest of `view`'s winners whose partner the pixel is.
/// A winner is a cost and a disparity in pixels; ties go to the smaller disparity.
pub fn claim(winners: &Plane<Option<(u32, i32)>>, view: View) -> DisparityMap {
    let Size { width, height } = winners.size();
    let mut claims: Plane<Option<(u32, i32)>> = Plane::filled((width, height), None);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let Some((cost, disparity)) = winners.get(x, y) else { continue };
        let partner = i64::from(x) + i64::from(view.direction()) * i64::from(disparity);
        if (0..i64::from(width)).contains(&partner) {
            let held = claims.get(partner as u32, y);
            if held.is_none_or(|held| (cost, disparity) < held) {
                claims.set(partner as u32, y, Some((cost, disparity)));
            }
        }
    }
    claims.map(|claim| claim.map_or(NONE, |(_, disparity)| disparity * SCALE))
}
