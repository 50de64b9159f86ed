//! Photometric residuals, from the definition.

use crate::{
    dense::{View, kernels::MAX_RESIDUAL},
    disparity::{DisparityMap, NONE, SCALE},
    image::{Luma, Plane, Size},
};

/// The residual of each pixel of the `reference` view: the absolute difference of its luma from its partner's, at the
/// nearest whole disparity, at most [`MAX_RESIDUAL`]. Pixels without disparity have residual 0, pixels whose partner
/// lies outside have [`MAX_RESIDUAL`].
pub fn residual([left, right]: [&Luma; 2], reference: View, disparities: &DisparityMap) -> Plane<u8> {
    let Size { width, height } = disparities.size();
    let (own, other) = if reference == View::Left { (left, right) } else { (right, left) };
    Plane::from_fn((width, height), |x, y| {
        let disparity = disparities.get(x, y);
        if disparity == NONE {
            return 0;
        }
        let nearest = (disparity + SCALE / 2).div_euclid(SCALE);
        let partner = i64::from(x) + i64::from(reference.direction()) * i64::from(nearest);
        if !(0..i64::from(width)).contains(&partner) {
            return MAX_RESIDUAL;
        }
        own.get(x, y).abs_diff(other.get(partner as u32, y)).min(MAX_RESIDUAL)
    })
}
