//! Left-right consistency, from the definition.

use crate::{
    dense::{Dense, View, kernels::HALF_GRAIN},
    disparity::{DisparityMap, NONE, SCALE},
    image::Size,
};

/// Drops the disparities that the other view contradicts: the partner of a pixel, at the nearest whole disparity, must
/// exist and have a disparity that differs by at most `max_difference` / 256 px.
pub fn consistency(dense: &mut Dense, view: View, other_disparities: &DisparityMap, max_difference: u32) {
    keep_confirmed(dense, view, |disparity, partner, y| {
        let other = other_disparities.get(partner, y);
        other != NONE && disparity.abs_diff(other) <= max_difference
    });
}

/// Drops the disparities that the half-size map of the other view contradicts: twice the whole disparity of the
/// half-size partner, or of the pixel to its left or right, must differ by at most `max_difference` / 256 px plus 1 px,
/// since twice a whole half-size disparity is even.
pub fn half_consistency(dense: &mut Dense, view: View, other_disparities: &DisparityMap, max_difference: u32) {
    keep_confirmed(dense, view, |disparity, partner, y| {
        (-1..=1).any(|i| {
            let other = other_disparities.get_clamped(i64::from(partner / 2) + i, i64::from(y / 2));
            other != NONE && disparity.abs_diff(2 * other) <= max_difference + HALF_GRAIN
        })
    });
}

/// Drops unconfirmed disparities. The arguments of `is_confirmed` are the disparity, the partner's column in the other
/// view, and the row.
fn keep_confirmed(dense: &mut Dense, view: View, is_confirmed: impl Fn(i32, u32, u32) -> bool) {
    let Size { width, height } = dense.disparity.size();
    for y in 0..height {
        for x in 0..width {
            let disparity = dense.disparity.get(x, y);
            if disparity == NONE {
                continue;
            }
            let whole = (disparity + SCALE / 2).div_euclid(SCALE);
            let partner = match view {
                View::Left => i64::from(x) - i64::from(whole),
                View::Right => i64::from(x) + i64::from(whole),
            };
            let confirmed = (0..i64::from(width)).contains(&partner) && is_confirmed(disparity, partner as u32, y);
            if !confirmed {
                dense.disparity.set(x, y, NONE);
                dense.confidence.set(x, y, 0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;

    #[test]
    fn by_hand() {
        let plane = |values: &[i32]| Plane::new((values.len() as u32, 1), values.to_vec()).unwrap();
        let disparity = plane(&[0, 256, 300, 2 * 256, NONE, 6 * 256]);
        let mut dense = Dense { confidence: disparity.map(|&d| if d == NONE { 0 } else { 9 }), disparity };
        // Partners: 0 of 0; 0 of 1; 1 of 2 (300 is nearest to one pixel); 1 of 3; outside.
        let other_disparities = plane(&[40, 260, NONE, 0, 0, 0]);
        consistency(&mut dense, View::Left, &other_disparities, 40);
        assert_eq!(dense.disparity.data(), [0, NONE, 300, NONE, NONE, NONE]);
        assert_eq!(dense.confidence.data(), [9, 0, 9, 0, 0, 0]);

        // At half size. Pixel 3 has partner 2, half-size pixel 1: an odd disparity lies between even ones. Pixel 4 has
        // partner 1, half-size pixel 0, and its neighbour has another disparity. Pixel 5 has partner 3, half-size pixel
        // 1, and its neighbour has half the disparity.
        let mut dense =
            Dense { disparity: plane(&[NONE, NONE, NONE, 256, 800, 512]), confidence: Plane::filled((6, 1), 9) };
        half_consistency(&mut dense, View::Left, &plane(&[NONE, 0, 256, NONE]), 0);
        assert_eq!(dense.disparity.data(), [NONE, NONE, NONE, 256, NONE, 512]);

        let mut dense = Dense { disparity: plane(&[-128, 256, 256]), confidence: Plane::filled((3, 1), 9) };
        // -128 is a half: up, to 0.
        consistency(&mut dense, View::Right, &plane(&[-128, 0, 256]), 0);
        assert_eq!(dense.disparity.data(), [-128, 256, NONE]);
    }
}
