//! The few functions that the standard library leaves to the platform, as polynomials.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Sine and cosine of an angle in degrees, by Taylor series on +-45 degrees (error below 1e-13).
pub fn sin_cos(degrees: f64) -> (f64, f64) {
    let quadrant = (degrees / 90.0).round();
    let a = (degrees - 90.0 * quadrant) * (PI / 180.0);
    let (mut sine, mut cosine) = (0.0, 0.0);
    let mut term = 1.0;
    for n in 0..16 {
        let sign = if n % 4 < 2 { 1.0 } else { -1.0 };
        if n % 2 == 0 {
            cosine += sign * term;
        } else {
            sine += sign * term;
        }
        term *= a / f64::from(n + 1);
    }
    match quadrant.rem_euclid(4.0) as u32 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// Sine of `x` full turns.
pub fn wave(x: f64) -> f64 {
    sin_cos((x - x.floor()) * 360.0).0
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

/// Radians to a distance along a circle.
pub fn arc(y: f64, x: f64, radius: f64) -> f64 {
    angle(y, x).clamp(-TAU, TAU) * radius
}
