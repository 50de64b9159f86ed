//! Radial, tangential and thin-prism distortion of a lens.

use glam::{DMat2, DVec2};

use super::monotone::{first_root, inverse};
use crate::error::{Error, Result, check};

/// Largest accepted coefficient: fits to few points reach some hundreds.
const MOST: f64 = 1e6;
/// Squared radius at which distortion ends at the latest: 89.9 degrees off the axis.
const FARTHEST: f64 = 3e5;
const NEWTON_STEPS: u32 = 40;

/// Distortion in the plane at depth 1: Brown, 'Decentering distortion of lenses', Photogrammetric Engineering 32(3), 1966,
/// with the rational radial part of Claus and Fitzgibbon, 'A rational function lens distortion model for general cameras',
/// CVPR 2005, and the thin-prism part of Weng, Cohen and Herniou, 'Camera calibration with distortion models and accuracy
/// evaluation', PAMI 14(10), 1992. Signs and order of the coefficients are OpenCV's.
///
/// With `u = x^2 + y^2` and `g = (1 + k1 u + k2 u^2 + k3 u^3) / (1 + k4 u + k5 u^2 + k6 u^3)`:
///
/// ```text
/// x_d = x g + 2 p1 x y + p2 (u + 2 x^2) + s1 u + s2 u^2
/// y_d = y g + p1 (u + 2 y^2) + 2 p2 x y + s3 u + s4 u^2
/// ```
///
/// The model is defined where `r g(r^2)` rises from the axis on without a break. Beyond, such polynomials fold: a point
/// far outside the field of view would appear inside the picture a second time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialTangential {
    k: [f64; 6],
    p: [f64; 2],
    s: [f64; 4],
    /// Squared radius at which the model ends.
    end: f64,
}

impl RadialTangential {
    /// No distortion.
    pub const NONE: Self = Self { k: [0.0; 6], p: [0.0; 2], s: [0.0; 4], end: f64::INFINITY };

    /// Distortion by OpenCV's coefficients `k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4`; those that are left out are 0.
    ///
    /// # Errors
    /// [`Error::Parameter`] for more than 12 coefficients other than 0, and for coefficients that are no numbers or above
    /// 10^6.
    pub fn new(coefficients: &[f64]) -> Result<Self> {
        let at = |place: usize| coefficients.get(place).copied().unwrap_or(0.0);
        for &coefficient in coefficients {
            check(coefficient.abs() <= MOST, "a distortion coefficient", coefficient, "it must be -10^6 to 10^6")?;
        }
        if coefficients.iter().skip(12).any(|&coefficient| coefficient != 0.0) {
            return Err(Error::Parameter {
                name: "the distortion",
                value: format!("{} coefficients", coefficients.len()),
                expected: "a tilted sensor (the coefficients after s4) is not supported: calibrate without \
                           CALIB_TILTED_MODEL"
                    .into(),
            });
        }
        let k = [at(0), at(1), at(4), at(5), at(6), at(7)];
        let mut distortion = Self { k, p: [at(2), at(3)], s: [at(8), at(9), at(10), at(11)], end: f64::INFINITY };
        if k != [0.0; 6] {
            distortion.end = distortion.radial_end();
        }
        Ok(distortion)
    }

    /// True without any distortion.
    pub fn is_none(&self) -> bool {
        (self.k, self.p, self.s) == ([0.0; 6], [0.0; 2], [0.0; 4])
    }

    /// The coefficients `k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4`.
    pub fn coefficients(&self) -> [f64; 12] {
        let ([k1, k2, k3, k4, k5, k6], [p1, p2], [s1, s2, s3, s4]) = (self.k, self.p, self.s);
        [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4]
    }

    /// The distorted place of a point; `None` where the model is not defined.
    pub(super) fn distorted(&self, point: DVec2) -> Option<DVec2> {
        let is_defined = point.length_squared() < self.end;
        is_defined.then(|| self.value_and_jacobian(point)).and_then(|(value, jacobian)| {
            // Tangential parts fold too, where they outweigh the radial part.
            (jacobian.determinant() > 0.0 && value.is_finite()).then_some(value)
        })
    }

    /// The point whose distorted place is `target`; `None` if no point of the model's domain is.
    ///
    /// Newton's method from the inverse of the radial part, with steps halved until the residual falls.
    pub(super) fn undistorted(&self, target: DVec2) -> Option<DVec2> {
        if self.is_none() {
            return Some(target);
        }
        let radius = target.length();
        let most = self.end.min(FARTHEST).sqrt();
        let radial = |r: f64| {
            let (g, slope) = self.radial(r * r);
            (r * g, g + 2.0 * r * r * slope)
        };
        let start = inverse(radial, radius, most).unwrap_or(0.999 * most);
        let mut point = if radius > 0.0 { target * (start / radius) } else { target };
        let mut residual = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            let (value, jacobian) = self.value_and_jacobian(point);
            let off = value - target;
            residual = off.length();
            if residual <= f64::EPSILON * (1.0 + radius) {
                break;
            }
            let step = jacobian.inverse() * off;
            let shorter = (0..10).map(|halvings| point - step * 0.5_f64.powi(halvings));
            let better = shorter.into_iter().find(|&next| {
                next.length_squared() < self.end && (self.value_and_jacobian(next).0 - target).length() < residual
            });
            match better {
                Some(next) => point = next,
                None => break,
            }
        }
        (residual <= 1e-12 * (1.0 + radius) && self.distorted(point).is_some()).then_some(point)
    }

    /// `g` and its derivative by the squared radius.
    fn radial(&self, u: f64) -> (f64, f64) {
        let [k1, k2, k3, k4, k5, k6] = self.k;
        let (above, below) = (1.0 + u * (k1 + u * (k2 + u * k3)), 1.0 + u * (k4 + u * (k5 + u * k6)));
        let slopes = [k1 + u * (2.0 * k2 + u * 3.0 * k3), k4 + u * (2.0 * k5 + u * 3.0 * k6)];
        (above / below, (slopes[0] * below - above * slopes[1]) / (below * below))
    }

    fn value_and_jacobian(&self, point: DVec2) -> (DVec2, DMat2) {
        let ([p1, p2], [s1, s2, s3, s4], DVec2 { x, y }) = (self.p, self.s, point);
        let u = point.length_squared();
        let (g, slope) = self.radial(u);
        let value = point * g
            + DVec2::new(
                2.0 * p1 * x * y + p2 * (u + 2.0 * x * x) + u * (s1 + s2 * u),
                p1 * (u + 2.0 * y * y) + 2.0 * p2 * x * y + u * (s3 + s4 * u),
            );
        let mixed = 2.0 * (x * y * slope + p1 * x + p2 * y);
        let prism = [2.0 * (s1 + 2.0 * s2 * u), 2.0 * (s3 + 2.0 * s4 * u)];
        let by_x =
            DVec2::new(g + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x + x * prism[0], mixed + x * prism[1]);
        let by_y =
            DVec2::new(mixed + y * prism[0], g + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x + y * prism[1]);
        (value, DMat2::from_cols(by_x, by_y))
    }

    /// Squared radius at which `r g(r^2)` stops to rise: where its denominator, or the numerator of its derivative,
    /// `(N + 2 u N') D - 2 u N D'`, is 0.
    fn radial_end(&self) -> f64 {
        let [k1, k2, k3, k4, k5, k6] = self.k;
        let (above, below) = ([1.0, k1, k2, k3], [1.0, k4, k5, k6]);
        let mut derivative = [0.0; 7];
        for (i, n) in above.into_iter().enumerate() {
            for (j, d) in below.into_iter().enumerate() {
                derivative[i + j] += n * d * (1.0 + 2.0 * i as f64 - 2.0 * j as f64);
            }
        }
        first_root(&derivative, FARTHEST).min(first_root(&below, FARTHEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jacobian_is_the_derivative() {
        let lens = RadialTangential::new(&[
            -0.28, 0.09, 0.0011, -0.0007, 0.012, 0.05, -0.02, 0.003, 0.002, -0.0015, 0.0009, 0.0004,
        ])
        .unwrap();
        for point in [DVec2::new(0.3, -0.2), DVec2::new(-0.7, 0.6)] {
            let (_, jacobian) = lens.value_and_jacobian(point);
            let step = 1e-6;
            for (axis, column) in [(DVec2::X, jacobian.x_axis), (DVec2::Y, jacobian.y_axis)] {
                let at = |sign: f64| lens.value_and_jacobian(point + axis * (sign * step)).0;
                let numeric = (at(1.0) - at(-1.0)) / (2.0 * step);
                assert!((numeric - column).length() < 1e-9, "{point}: {numeric} {column}");
            }
        }
    }

    #[test]
    fn a_polynomial_ends_where_it_folds() {
        // r (1 - 0.3 r^2) rises up to r^2 = 1 / 0.9.
        let lens = RadialTangential::new(&[-0.3]).unwrap();
        assert!((lens.end - 1.0 / 0.9).abs() < 1e-12);
        assert!(lens.distorted(DVec2::new(1.05, 0.0)).is_some());
        assert_eq!(lens.distorted(DVec2::new(1.06, 0.0)), None);
        // The largest value is 2/3 of the radius there.
        assert!(lens.undistorted(DVec2::new(0.7, 0.0)).is_some());
        assert_eq!(lens.undistorted(DVec2::new(0.0, 0.71)), None);
        // 1 - 0.9 u + 0.5 u^2 has no root.
        assert_eq!(RadialTangential::new(&[-0.3, 0.1]).unwrap().end, FARTHEST);
        // A pole at r^2 = 4.
        assert!(RadialTangential::new(&[0.0, 0.0, 0.0, 0.0, 0.0, -0.25]).unwrap().end <= 4.0);
    }

    #[test]
    fn coefficients_are_checked() {
        for (coefficients, expected) in [
            (&[f64::NAN][..], "a distortion coefficient is NaN"),
            (&[0.0, 1e9], "a distortion coefficient is 1000000000"),
            (&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0], "a tilted sensor"),
        ] {
            let error = RadialTangential::new(coefficients).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        // 14 coefficients without tilt.
        assert!(RadialTangential::new(&[0.0; 14]).unwrap().is_none());
    }
}
