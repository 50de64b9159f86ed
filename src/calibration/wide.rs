//! Models of lenses that see 180 degrees and more: a point on a sphere, or a pair of spheres, seen from beside its centre.
//!
//! All have the form of Usenko, Demmel and Cremers, 'The Double Sphere Camera Model', 3DV 2018, which collects them with their
//! inverses in closed form.

use glam::{DVec2, DVec3};

use super::{
    RadialTangential,
    monotone::{first_root, inverse},
};
use crate::error::{Result, check};

/// Equidistant projection with a polynomial: Kannala and Brandt, 'A generic camera model and calibration method for
/// conventional, wide-angle, and fish-eye lenses', PAMI 28(8), 2006, equation 6; OpenCV's module `fisheye`.
///
/// A ray `theta` off the axis appears at the radius `theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)`. The
/// model is defined up to the angle at which the radius stops to rise, at most 180 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KannalaBrandt {
    k: [f64; 4],
    /// Largest angle off the axis, in radians.
    end: f64,
}

impl KannalaBrandt {
    /// A lens with the coefficients `k1` to `k4`.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for coefficients that are no numbers or above 10^6.
    pub fn new(k: [f64; 4]) -> Result<Self> {
        for coefficient in k {
            check(coefficient.abs() <= 1e6, "a distortion coefficient", coefficient, "it must be -10^6 to 10^6")?;
        }
        let [k1, k2, k3, k4] = k;
        let pi = std::f64::consts::PI;
        Ok(Self { k, end: first_root(&[1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4], pi * pi).sqrt() })
    }

    /// The coefficients `k1` to `k4`.
    pub fn coefficients(&self) -> [f64; 4] {
        self.k
    }

    pub(super) fn project(&self, ray: DVec3) -> Option<DVec2> {
        let across = ray.truncate();
        let radius = across.length();
        let theta = libm::atan2(radius, ray.z);
        if radius == 0.0 {
            return (ray.z > 0.0).then_some(DVec2::ZERO);
        }
        (theta < self.end).then(|| across * (self.radius(theta).0 / radius))
    }

    pub(super) fn unproject(&self, place: DVec2) -> Option<DVec3> {
        let radius = place.length();
        if radius == 0.0 {
            return Some(DVec3::Z);
        }
        let theta = inverse(|theta| self.radius(theta), radius, self.end)?;
        let (sin, cos) = libm::sincos(theta);
        Some((place * (sin / radius)).extend(cos))
    }

    /// The radius at an angle, and its derivative.
    fn radius(&self, theta: f64) -> (f64, f64) {
        let ([k1, k2, k3, k4], v) = (self.k, theta * theta);
        let value = theta * (1.0 + v * (k1 + v * (k2 + v * (k3 + v * k4))));
        (value, 1.0 + v * (3.0 * k1 + v * (5.0 * k2 + v * (7.0 * k3 + v * 9.0 * k4))))
    }
}

/// Unified model: Mei and Rives, 'Single view point omnidirectional camera calibration from planar grids', ICRA 2007,
/// section II; OpenCV's module `omnidir`, Kalibr's `omni`.
///
/// A point on the unit sphere is seen from `xi` behind the centre and then distorted. The plane at depth 1 shows what lies in
/// front of `z = -min(xi, 1 / xi)` on the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unified {
    xi: f64,
    distortion: RadialTangential,
}

impl Unified {
    /// A lens with `xi`, at least 0, and a distortion.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for `xi` outside 0 to 1000.
    pub fn new(xi: f64, distortion: RadialTangential) -> Result<Self> {
        check((0.0..=1e3).contains(&xi), "xi", xi, "it must be 0 to 1000")?;
        Ok(Self { xi, distortion })
    }

    /// The distance of the centre of projection from the sphere's centre, in radii.
    pub fn xi(&self) -> f64 {
        self.xi
    }

    /// The distortion after the projection.
    pub fn distortion(&self) -> &RadialTangential {
        &self.distortion
    }

    pub(super) fn project(&self, ray: DVec3) -> Option<DVec2> {
        let (xi, length) = (self.xi, ray.length());
        let end = if xi <= 1.0 { xi } else { 1.0 / xi };
        (ray.z > -end * length)
            .then(|| ray.truncate() / (ray.z + xi * length))
            .and_then(|m| self.distortion.distorted(m))
    }

    pub(super) fn unproject(&self, place: DVec2) -> Option<DVec3> {
        let place = self.distortion.undistorted(place)?;
        let (xi, square) = (self.xi, place.length_squared());
        let root = 1.0 + (1.0 - xi * xi) * square;
        (root >= 0.0).then(|| {
            let scale = (xi + root.sqrt()) / (1.0 + square);
            (place * scale).extend(scale - xi)
        })
    }
}

/// Extended unified model: Khomutenko, Garcia and Martinet, 'An enhanced unified camera model', RA-L 1(1), 2016, with the
/// domain and the inverse of Usenko et al., equations 26 to 34.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtendedUnified {
    alpha: f64,
    beta: f64,
}

impl ExtendedUnified {
    /// A lens with `alpha`, 0 to 1, and `beta`, above 0.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for values outside their range.
    pub fn new(alpha: f64, beta: f64) -> Result<Self> {
        check((0.0..=1.0).contains(&alpha), "alpha", alpha, "it must be 0 to 1")?;
        check((1e-6..=1e6).contains(&beta), "beta", beta, "it must be 10^-6 to 10^6")?;
        Ok(Self { alpha, beta })
    }

    /// `alpha` and `beta`.
    pub fn parameters(&self) -> [f64; 2] {
        [self.alpha, self.beta]
    }

    pub(super) fn project(&self, ray: DVec3) -> Option<DVec2> {
        let Self { alpha, beta } = *self;
        let distance = (beta * ray.truncate().length_squared() + ray.z * ray.z).sqrt();
        (ray.z > -farthest(alpha) * distance).then(|| ray.truncate() / (alpha * distance + (1.0 - alpha) * ray.z))
    }

    pub(super) fn unproject(&self, place: DVec2) -> Option<DVec3> {
        let Self { alpha, beta } = *self;
        let z = depth_of(alpha, beta * place.length_squared())?;
        Some(place.extend(z).normalize())
    }
}

/// Double sphere model: Usenko, Demmel and Cremers, equations 40 to 52.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleSphere {
    xi: f64,
    alpha: f64,
}

impl DoubleSphere {
    /// A lens with `xi`, between -1 and 1, and `alpha`, 0 to 1.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for values outside their range.
    pub fn new(xi: f64, alpha: f64) -> Result<Self> {
        check(xi > -1.0 && xi <= 1.0, "xi", xi, "it must be above -1 and at most 1")?;
        check((0.0..=1.0).contains(&alpha), "alpha", alpha, "it must be 0 to 1")?;
        Ok(Self { xi, alpha })
    }

    /// `xi` and `alpha`.
    pub fn parameters(&self) -> [f64; 2] {
        [self.xi, self.alpha]
    }

    pub(super) fn project(&self, ray: DVec3) -> Option<DVec2> {
        let Self { xi, alpha } = *self;
        let first = ray.length();
        let w1 = farthest(alpha);
        let w2 = (w1 + xi) / (2.0 * w1 * xi + xi * xi + 1.0).sqrt();
        let z = xi * first + ray.z;
        let second = (ray.truncate().length_squared() + z * z).sqrt();
        (ray.z > -w2 * first).then(|| ray.truncate() / (alpha * second + (1.0 - alpha) * z))
    }

    pub(super) fn unproject(&self, place: DVec2) -> Option<DVec3> {
        let Self { xi, alpha } = *self;
        let square = place.length_squared();
        let z = depth_of(alpha, square)?;
        let root = z * z + (1.0 - xi * xi) * square;
        (root >= 0.0).then(|| {
            let scale = (z * xi + root.sqrt()) / (z * z + square);
            (place * scale).extend(z * scale - xi)
        })
    }
}

/// The share of the distance behind the centre up to which points are projected.
fn farthest(alpha: f64) -> f64 {
    if alpha <= 0.5 { alpha / (1.0 - alpha) } else { (1.0 - alpha) / alpha }
}

/// Depth of the sphere's point over a place at the squared radius `square`; `None` beyond the sphere's outline.
fn depth_of(alpha: f64, square: f64) -> Option<f64> {
    let root = 1.0 - (2.0 * alpha - 1.0) * square;
    (root >= 0.0).then(|| (1.0 - alpha * alpha * square) / (alpha * root.sqrt() + 1.0 - alpha))
}
