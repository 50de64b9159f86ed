//! Polynomials for the few functions that the standard library leaves to the platform.

use std::f64::consts::{FRAC_PI_2, PI};

/// Sine and cosine of an angle in degrees, by Taylor series on +-45 degrees (error below 1e-12).
pub fn sin_cos(degrees: f64) -> (f64, f64) {
    let quadrant = (degrees / 90.0).round();
    let a = (degrees - 90.0 * quadrant) * (PI / 180.0);
    let s = a * a;
    // Horner's scheme: each factor is the next term over the one before.
    let series = |ratios: [f64; 6]| ratios.iter().rev().fold(1.0, |rest, ratio| 1.0 - s * ratio * rest);
    let sine = a * series([1.0 / 6.0, 1.0 / 20.0, 1.0 / 42.0, 1.0 / 72.0, 1.0 / 110.0, 1.0 / 156.0]);
    let cosine = series([1.0 / 2.0, 1.0 / 12.0, 1.0 / 30.0, 1.0 / 56.0, 1.0 / 90.0, 1.0 / 132.0]);
    match quadrant as i64 & 3 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// A smooth approximation of the sine of `x` full turns by parabolas (error below 0.002).
pub fn wave(x: f64) -> f64 {
    let f = x - x.floor();
    let arch = if f < 0.5 { 16.0 * f * (0.5 - f) } else { 16.0 * (f - 0.5) * (f - 1.0) };
    arch * (0.775 + 0.225 * arch.abs())
}

/// The angle of (x, y) in radians, -pi to pi (error about 1e-5; Abramowitz and Stegun 4.4.49, shortened by Hastings).
pub fn angle(y: f64, x: f64) -> f64 {
    let (small, large) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    if large == 0.0 {
        return 0.0;
    }
    let r = small / large;
    let s = r * r;
    let octant =
        r * (0.99997726 + s * (-0.33262347 + s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 - s * 0.01172120)))));
    let quadrant = if y.abs() > x.abs() { FRAC_PI_2 - octant } else { octant };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y < 0.0 { -half } else { half }
}

/// Point `i` of `n` spread evenly over the unit sphere: a Fibonacci spiral.
pub fn on_sphere(i: u32, n: u32) -> glam::DVec3 {
    /// The golden angle.
    const TURN: f64 = 137.507_764_050_037_85;
    let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
    let radius = (1.0 - y * y).sqrt();
    let (sine, cosine) = sin_cos(TURN * f64::from(i));
    glam::DVec3::new(radius * cosine, y, radius * sine)
}

/// 0 below `a`, 1 above `b`, smooth between them.
pub fn smoothstep(a: f64, b: f64, x: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `a` at `t` = 0, `b` at 1.
pub fn mix<T>(a: T, b: T, t: f64) -> T
where
    T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
{
    a * (1.0 - t) + b * t
}

/// The distance along a circle of this radius from the direction (0, 1) to (y, x).
pub fn arc(y: f64, x: f64, radius: f64) -> f64 {
    angle(y, x) * radius
}
