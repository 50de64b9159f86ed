//! What the other view sees, told from one view's winners, from the definition.

use crate::{
    dense::View,
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
};

/// For each pixel of the other view the whole disparity of the cheapest of `view`'s winners, each a cost and a
/// disparity in pixels, whose partner it is. Of equal costs the smaller disparity holds.
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
