//! Resampling by an affine map.

use glam::{DAffine2, DVec2};

use super::{grey, in_parallel};
use crate::image::{Plane, Size};

/// Similarity about the centre of a picture of `size` (width and height in pixels): rotates by `angle` degrees,
/// clockwise on the screen, and enlarges by `scale`.
///
/// Multiples of 90 degrees are exact; other angles are exact up to the rounding of `f64`.
pub fn about_centre(size: impl Into<Size>, angle: f64, scale: f64) -> DAffine2 {
    let Size { width, height } = size.into();
    let quarters = (angle / 90.0).round();
    let rest = (angle - 90.0 * quarters).to_radians();
    let (sin, cos) = (libm::sin(rest), libm::cos(rest));
    let (sin, cos) = match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    };
    let linear = glam::DMat2::from_cols(DVec2::new(cos, sin), DVec2::new(-sin, cos)) * scale;
    let centre = DVec2::new(f64::from(width - 1), f64::from(height - 1)) / 2.0;
    DAffine2::from_mat2_translation(linear, centre - linear * centre)
}

/// Resamples `plane` to a picture of `size` (width and height in pixels) that shows at `map(p)` the value of `plane` at
/// `p`. Returns the picture and a mask: 255 where it shows the plane; 0 beyond the plane's edge, where it is `fill`.
///
/// Interpolation by Catmull-Rom splines (Keys 1981, a = -1/2). If `map` shrinks the plane, a pixel is the mean of
/// enough samples to cover it, up to 8x8.
pub fn resample<const N: usize>(
    plane: &Plane<[u8; N]>,
    map: DAffine2,
    size: impl Into<Size>,
    fill: [u8; N],
) -> (Plane<[u8; N]>, Plane<u8>) {
    let size = size.into();
    let Size { width, height } = plane.size();
    let back = map.inverse();
    let samples = ((1.0 / map.matrix2.determinant().abs().sqrt() - 1e-9).ceil() as u32).clamp(1, 8);
    let offsets: Vec<f64> = (0..samples).map(|i| (f64::from(i) + 0.5) / f64::from(samples) - 0.5).collect();
    let inside = |p: DVec2| p.x >= -0.5 && p.y >= -0.5 && p.x < f64::from(width) - 0.5 && p.y < f64::from(height) - 0.5;
    let is_visible = |x: u32, y: u32| inside(back.transform_point2(DVec2::new(x.into(), y.into())));
    let visible = in_parallel(size, |x, y| if is_visible(x, y) { 255 } else { 0 });
    let changed = in_parallel(size, |x, y| {
        if visible.get(x, y) == 0 {
            return fill;
        }
        let mut sum = [0.0; N];
        for dy in &offsets {
            for dx in &offsets {
                let at = back.transform_point2(DVec2::new(f64::from(x) + dx, f64::from(y) + dy));
                add_interpolated(plane, at, &mut sum);
            }
        }
        sum.map(|sum| grey(sum / f64::from(samples * samples)))
    });
    (changed, visible)
}

/// Adds the interpolated values at the position `at` to `sum`.
fn add_interpolated<const N: usize>(plane: &Plane<[u8; N]>, at: DVec2, sum: &mut [f64; N]) {
    let (left, top) = (at.x.floor(), at.y.floor());
    let (across, down) = (weights(at.x - left), weights(at.y - top));
    for (j, weight_y) in (-1..).zip(down) {
        for (i, weight_x) in (-1..).zip(across) {
            let pixel = plane.get_clamped(left as i64 + i, top as i64 + j);
            sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += weight_x * weight_y * f64::from(value));
        }
    }
}

/// Weights of the pixels at -1, 0, 1 and 2 for the position `t`, 0 to 1.
fn weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [0.5 * (-t3 + 2.0 * t2 - t), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (-3.0 * t3 + 4.0 * t2 + t), 0.5 * (t3 - t2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_add_up_and_keep_pixels() {
        assert_eq!(weights(0.0), [0.0, 1.0, 0.0, 0.0]);
        for t in [0.1, 0.5, 0.9] {
            assert!((weights(t).iter().sum::<f64>() - 1.0).abs() < 1e-12);
            // A linear ramp is reproduced exactly.
            let line: f64 = weights(t).iter().zip([-1.0, 0.0, 1.0, 2.0]).map(|(w, x)| w * x).sum();
            assert!((line - t).abs() < 1e-12);
        }
    }

    #[test]
    fn a_quarter_turn_moves_whole_pixels() {
        let picture = Plane::from_fn((5, 5), |x, y| [(10 * x + y) as u8, 0, 0, 255]);
        let map = about_centre((5, 5), 90.0, 1.0);
        let (turned, visible) = resample(&picture, map, (5, 5), [0; 4]);
        // Clockwise: the top left corner goes to the top right.
        assert_eq!(map.transform_point2(DVec2::ZERO), DVec2::new(4.0, 0.0));
        assert_eq!(turned, Plane::from_fn((5, 5), |x, y| picture.get(y, 4 - x)));
        assert!(visible.data().iter().all(|&v| v == 255));
    }

    #[test]
    fn angles_beyond_a_quarter_are_the_same_as_by_trigonometry() {
        for angle in [-180.0f64, -100.0, -45.0, 30.0, 44.9, 45.1, 135.0, 170.0] {
            let map = about_centre((9, 9), angle, 2.0);
            let (sin, cos) = angle.to_radians().sin_cos();
            assert!((map.matrix2.x_axis - 2.0 * DVec2::new(cos, sin)).length() < 1e-12, "{angle}");
            assert!((map.transform_point2(DVec2::splat(4.0)) - DVec2::splat(4.0)).length() < 1e-12);
        }
    }

    #[test]
    fn half_the_size_is_the_mean_of_blocks_of_a_ramp() {
        let picture = Plane::from_fn((20, 20), |x, _| [10 * x as u8, 0, 0, 255]);
        let map = about_centre((20, 20), 0.0, 0.5);
        let (small, visible) = resample(&picture, map, (20, 20), [9; 4]);
        // Column 7 shows the original columns 4 and 5: 9.5 + 2 (7 - 9.5) = 4.5.
        assert_eq!(
            (small.get(7, 10)[0], small.get(4, 10), visible.get(4, 10), visible.get(5, 10)),
            (45, [9; 4], 0, 255)
        );
    }
}
