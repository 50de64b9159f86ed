//! The fundamental matrix of two views.

use glam::{DMat3, DVec2, DVec3};

use super::{
    frame::{AGREEMENT, Frame, PRECISION},
    lenses::Lenses,
    linear::{null_space, rotation, singular},
    minimise::{minimise, sum_of_logarithms},
    sample::Samples,
};
use crate::rectify::Correspondence;

/// Number of samples of seven points: with 60 % of inliers 56 of them are free of outliers.
const SAMPLES: usize = 2000;
/// Number of points on which candidates are tested, the first ones.
const TRIED: usize = 800;
/// Number of times that inliers are chosen and the matrix is refined.
const ROUNDS: usize = 3;

/// A fundamental matrix: `r' F l = 0` for the homogeneous coordinates of corresponding points, in units of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fundamental(pub DMat3);

impl Fundamental {
    /// Distance of a correspondence from the nearest one that agrees with the matrix, to first order and with a sign (Sampson's
    /// error; Hartley and Zisserman, Multiple View Geometry, 2003, equation 11.9).
    pub fn error(&self, point: &Correspondence) -> f64 {
        let (left, right) = (point.left.extend(1.0), point.right.extend(1.0));
        let (line, back) = (self.0 * left, self.0.transpose() * right);
        let slope = line.x * line.x + line.y * line.y + back.x * back.x + back.y * back.y;
        // An epipole itself agrees with any point.
        if slope > 0.0 { right.dot(line) / slope.sqrt() } else { 0.0 }
    }

    /// The epipoles in the left and in the right view, homogeneous.
    pub fn epipoles(&self) -> [DVec3; 2] {
        let (u, _, v) = singular(self.0);
        [v.z_axis, u.z_axis]
    }

    /// The points whose error is at most `most`.
    pub fn inliers(&self, points: &[Correspondence], most: f64) -> Vec<Correspondence> {
        points.iter().filter(|point| self.error(point).abs() <= most).copied().collect()
    }

    /// Sum over all points of `ln(1 + (r / 0.3 px)^2)` of their errors.
    pub fn cost(&self, points: &[Correspondence], unit: f64) -> f64 {
        sum_of_logarithms(points.iter().map(|point| self.error(point) * unit / PRECISION))
    }

    /// The matrix that most points agree with: seven points at a time in a fixed random sequence (Fischler and Bolles 1981), the
    /// cost of outliers limited (Torr and Zisserman, MLESAC, CVIU 78, 2000), then refined on its inliers; `None` for fewer than
    /// seven points, or points that determine no matrix.
    pub fn consensus(points: &[Correspondence], unit: f64) -> Option<Self> {
        let tried = &points[..points.len().min(TRIED)];
        let limit = AGREEMENT / unit;
        // The cost, if it is below `least`.
        let cost = |found: &Self, least: f64| {
            tried.iter().try_fold(0.0, |sum, point| {
                let sum = sum + (found.error(point) / limit).powi(2).min(1.0);
                (sum < least).then_some(sum)
            })
        };
        let mut best: Option<(f64, Self)> = None;
        for seven in Samples::<7>::of(points.len()).take(SAMPLES) {
            for found in through(seven.map(|index| points[index])) {
                let least = best.map_or(f64::INFINITY, |(least, _)| least);
                best = cost(&found, least).map(|cost| (cost, found)).or(best);
            }
        }
        let start = best?.1;
        let refined = (0..ROUNDS).try_fold(start, |found, _| found.refined(&found.inliers(points, limit), unit));
        refined.or(Some(start))
    }

    /// The matrix of the places without the distortion of `lenses`, refined, and its inliers among them.
    pub fn behind(self, lenses: Lenses, points: &[Correspondence], frame: &Frame) -> (Self, Vec<Correspondence>) {
        let straight = lenses.straight(points, frame);
        let near = |found: &Self, pixels: f64| found.inliers(&straight, pixels / frame.unit);
        let refined = [2.0 * AGREEMENT, AGREEMENT, AGREEMENT]
            .into_iter()
            .try_fold(self, |found, pixels| found.refined(&near(&found, pixels), frame.unit))
            .unwrap_or(self);
        let inliers = near(&refined, AGREEMENT);
        (refined, inliers)
    }

    /// The matrices of rank 2 around this one, `U diag(cos t, sin t, 0) V'`, by seven parameters, which are 0 for this one.
    pub fn around(&self) -> impl Fn(&[f64]) -> Self {
        let (u, values, v) = singular(self.0);
        let angle = libm::atan2(values[1], values[0]);
        move |by| {
            let (sin, cos) = libm::sincos(angle + by[6]);
            let middle = DMat3::from_diagonal(DVec3::new(cos, sin, 0.0));
            let (u, v) = (u * rotation(DVec3::from_slice(by)), v * rotation(DVec3::from_slice(&by[3..])));
            Self(u * middle * v.transpose())
        }
    }

    /// The matrix of least cost around this one. `None` for fewer than seven points.
    pub fn refined(&self, points: &[Correspondence], unit: f64) -> Option<Self> {
        if points.len() < 7 {
            return None;
        }
        let matrix = self.around();
        let found = minimise([0.0; 7], |parameters, errors| {
            let found = matrix(parameters);
            errors.robust.extend(points.iter().map(|point| found.error(point) * unit / PRECISION));
        });
        Some(matrix(&found.parameters))
    }
}

/// The matrices of rank 2 through seven points, up to three (Hartley and Zisserman 2003, section 11.1.2).
fn through(points: [Correspondence; 7]) -> Vec<Fundamental> {
    let equation = |Correspondence { left: DVec2 { x, y }, right }: Correspondence| {
        [right.x * x, right.x * y, right.x, right.y * x, right.y * y, right.y, x, y, 1.0]
    };
    let Some([a, b]) = null_space::<7, 9, 2>(points.map(equation)) else { return Vec::new() };
    let [a, b] = [a, b].map(|rows| DMat3::from_cols_array(&rows).transpose());
    // det(b + x (a - b)) is a cubic polynomial: from its values at -1, 0, 1 and at infinity.
    let step = a - b;
    let (constant, cubic) = (b.determinant(), step.determinant());
    let (plus, minus) = ((b + step).determinant(), (b - step).determinant());
    let square = (plus + minus) / 2.0 - constant;
    let linear = (plus - minus) / 2.0 - cubic;
    real_roots([cubic, square, linear, constant]).into_iter().map(|x| Fundamental(b + step * x)).collect()
}

/// The real roots of a cubic polynomial, the highest coefficient first (Cardano and Viete).
fn real_roots([a, b, c, d]: [f64; 4]) -> Vec<f64> {
    let largest = [b, c, d].into_iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    if a.abs() <= 1e-12 * largest || a.is_nan() {
        return Vec::new();
    }
    let (b, c, d) = (b / a, c / a, d / a);
    let shift = b / 3.0;
    // t^3 + p t + q with x = t - shift.
    let p = c - b * b / 3.0;
    let q = 2.0 * shift * shift * shift - shift * c + d;
    let discriminant = q * q / 4.0 + p * p * p / 27.0;
    if discriminant > 0.0 {
        let root = discriminant.sqrt();
        return vec![libm::cbrt(-q / 2.0 + root) + libm::cbrt(-q / 2.0 - root) - shift];
    }
    let radius = 2.0 * (-p / 3.0).sqrt();
    if radius == 0.0 {
        return vec![-shift];
    }
    let angle = libm::acos((3.0 * q / (p * radius)).clamp(-1.0, 1.0)) / 3.0;
    let third = std::f64::consts::TAU / 3.0;
    [0.0, third, 2.0 * third].map(|turn| radius * libm::cos(angle - turn) - shift).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_by_hand() {
        // (x - 1)(x + 2)(x - 3) and (x - 2)(x^2 + 1).
        let mut roots = real_roots([1.0, -2.0, -5.0, 6.0]);
        roots.sort_by(f64::total_cmp);
        for (root, expected) in roots.into_iter().zip([-2.0, 1.0, 3.0]) {
            assert!((root - expected).abs() < 1e-12);
        }
        let roots = real_roots([2.0, -4.0, 2.0, -4.0]);
        assert!(roots.len() == 1 && (roots[0] - 2.0).abs() < 1e-12);
        assert!(real_roots([0.0, 1.0, 2.0, 3.0]).is_empty());
    }
}
