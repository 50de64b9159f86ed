//! The dominant direction of the gradient around a point (Bay et al. 2008, section 4.1).

use std::f32::consts::{FRAC_PI_3, TAU};

use crate::cpu::features::{
    haar::{self, QuantizedPoint},
    integral::IntegralImage,
};

/// Radius of the neighbourhood, in scales.
const RADIUS: i32 = 6;
/// Standard deviation of the weights, in scales.
const SIGMA: f32 = 2.5;
/// Possible first directions of the sliding window of pi/3, half a step off the multiples of 45 degrees: gradients of
/// exactly those directions are common and must not lie on a window's end.
const WINDOWS: u32 = 48;

/// The orientation at a point, in radians, 0 to below 2 pi; 0 without any gradient.
pub fn orientation(integral: &IntegralImage, at: QuantizedPoint) -> f32 {
    direction(windows(&gradients(integral, at), 0.0).fold((0.0, 0.0), longer))
}

/// Whether the orientation is robust: the same for every implementation whose angles of gradients differ by up to
/// 0.0002 and whose sums of windows differ by up to one in a thousand. A robust orientation differs by 0.0005 at most.
pub fn is_decided(integral: &IntegralImage, at: QuantizedPoint) -> bool {
    /// Least length of a gradient that counts, in grey levels: smaller ones are lost in the rounding of sums.
    const LEAST_LENGTH: f32 = 0.25;
    let gradients = gradients(integral, at);
    if gradients.iter().all(|&(_, dx, dy)| (dx, dy) == (0.0, 0.0)) {
        return true;
    }
    let sums: Vec<_> = [-2e-4, 0.0, 2e-4].into_iter().flat_map(|shift| windows(&gradients, shift)).collect();
    let longest = sums.iter().copied().fold((0.0, 0.0), longer);
    let as_long = sums.iter().filter(|&&sum| length2(sum) >= 0.998 * length2(longest));
    let apart = |&sum: &(f32, f32)| {
        let difference = (direction(sum) - direction(longest)).abs();
        difference.min(TAU - difference)
    };
    let area = (4 * at.scale * at.scale) as f32;
    length2(longest).sqrt() >= LEAST_LENGTH * area && as_long.map(apart).all(|apart| apart <= 5e-4)
}

/// The sum of gradients in each window, all windows rotated by `shift`.
fn windows(gradients: &[(f32, f32, f32)], shift: f32) -> impl Iterator<Item = (f32, f32)> {
    (0..WINDOWS).map(move |window| {
        let start = (window as f32 + 0.5) * (TAU / WINDOWS as f32) + shift;
        let inside = gradients.iter().filter(|(angle, ..)| wrap(angle - start) < FRAC_PI_3);
        inside.fold((0.0, 0.0), |(dx, dy), (_, gx, gy)| (dx + gx, dy + gy))
    })
}

/// The longer of two vectors; the first of equally long ones.
fn longer(best: (f32, f32), sum: (f32, f32)) -> (f32, f32) {
    if length2(sum) > length2(best) { sum } else { best }
}

/// The direction of a vector, in radians, 0 to below 2 pi.
fn direction((dx, dy): (f32, f32)) -> f32 {
    wrap(dy.atan2(dx))
}

/// The weighted Haar responses of side 4 scales in the neighbourhood: angle, dx, dy.
fn gradients(integral: &IntegralImage, at: QuantizedPoint) -> Vec<(f32, f32, f32)> {
    let disc = (-RADIUS..=RADIUS).flat_map(|j| (-RADIUS..=RADIUS).map(move |i| (i, j)));
    disc.filter(|(i, j)| i * i + j * j < RADIUS * RADIUS)
        .map(|(i, j)| {
            let weight = (-((i * i + j * j) as f32) / (2.0 * SIGMA * SIGMA)).exp();
            let (dx, dy) = haar::responses(integral, at.x + i * at.scale, at.y + j * at.scale, 2 * at.scale);
            let (dx, dy) = (dx as f32, dy as f32);
            (wrap(dy.atan2(dx)), weight * dx, weight * dy)
        })
        .collect()
}

/// Wraps an angle above -2 pi to 0 to below 2 pi.
fn wrap(angle: f32) -> f32 {
    let wrapped = if angle < 0.0 { angle + TAU } else { angle };
    // A tiny negative angle rounds up to 2 pi.
    if wrapped >= TAU { 0.0 } else { wrapped }
}

fn length2((x, y): (f32, f32)) -> f32 {
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::image::Luma;

    fn assert_angle(actual: f32, expected: f32) {
        let difference = (actual - expected + PI).rem_euclid(TAU) - PI;
        assert!((0.0..TAU).contains(&actual) && difference.abs() < 1e-3, "{actual} instead of {expected}");
    }

    #[test]
    fn a_ramp_points_uphill() {
        // Slopes in x and y, and the uphill direction.
        for (sx, sy, expected) in [(1, 0, 0.0), (0, 1, FRAC_PI_2), (-1, 0, PI), (-1, -1, PI * 1.25)] {
            let ramp = |x: u32, y: u32| (sx * (x as i32 - 45) + sy * (y as i32 - 45) + 128) as u8;
            let integral = IntegralImage::new(&Luma::from_fn((91, 91), ramp));
            assert_angle(orientation(&integral, QuantizedPoint::new(45.0, 45.0, 2.0)), expected);
        }
    }

    #[test]
    fn rotating_the_picture_rotates_the_orientation() {
        let size = 81;
        let picture = Luma::from_fn((size, size), |x, y| ((x * 7 + y * 3) ^ (x * y / 5)) as u8);
        // A quarter turn from the x axis to the y axis takes (x, y) to (size - 1 - y, x).
        let turned = Luma::from_fn((size, size), |x, y| picture.get(y, size - 1 - x));
        for (x, y) in [(40, 40), (30, 44), (47, 35)] {
            let before = orientation(&IntegralImage::new(&picture), QuantizedPoint::new(x as f32, y as f32, 1.75));
            let (tx, ty) = ((size - 1 - y) as f32, x as f32);
            assert_angle(
                orientation(&IntegralImage::new(&turned), QuantizedPoint::new(tx, ty, 1.75)),
                before + FRAC_PI_2,
            );
        }
    }

    #[test]
    fn flat_has_orientation_zero() {
        let integral = IntegralImage::new(&Luma::filled((64, 64), 99));
        assert_eq!(orientation(&integral, QuantizedPoint::new(32.0, 32.0, 2.0)), 0.0);
    }

    #[test]
    fn what_last_digits_decide_is_told_apart() {
        let decided =
            |picture: &Luma, scale| is_decided(&IntegralImage::new(picture), QuantizedPoint::new(45.0, 45.0, scale));
        assert!(decided(&Luma::from_fn((91, 91), |x, y| (x + y) as u8), 2.0));
        assert!(decided(&Luma::filled((91, 91), 7), 2.0), "no gradient at all: everyone says 0");
        // A ridge rises from both sides alike.
        assert!(!decided(&Luma::from_fn((91, 91), |x, _| 200 - x.abs_diff(45) as u8), 2.0));
        // One grey level in a large window.
        assert!(!decided(&Luma::from_fn((91, 91), |x, y| u8::from((x, y) == (47, 46))), 12.0));
    }

    #[test]
    fn angles_stay_below_a_whole_turn() {
        assert_eq!(wrap(-1e-9), 0.0);
        assert_eq!(wrap(-FRAC_PI_2), 1.5 * PI);
        assert_eq!(wrap(0.5), 0.5);
    }
}
