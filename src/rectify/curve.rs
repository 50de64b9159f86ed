//! The rows of the right view as a curve with parameters, and its robust fit to corresponding points.

use glam::DVec2;

use super::cholesky::solved;

/// Largest number of free parameters: those of a projective model, and the distortion of the lens.
pub(super) const MOST: usize = 6;
/// Widths of the Cauchy weights, in pixels, the widest first: the first one reaches what a start within the tolerance of
/// inliers is off by, the last one is the precision of a match.
const WIDTHS: [f64; 3] = [3.0, 1.0, PRECISION];
/// Row error of a match that counts half, in pixels.
pub(super) const PRECISION: f64 = 0.3;
/// Largest number of steps per width.
const STEPS: usize = 8;
/// Smallest share of a diagonal element of the normal equations that has to remain.
const LEAST: f64 = 1e-10;
/// Steps end when no parameter changes by more, in units of the picture.
const SETTLED: f64 = 1e-9;

/// Corresponding points of both views, in units of half the larger side of the picture, from its centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub left: DVec2,
    pub right: DVec2,
}

/// The left row of a right pixel, `y (1 + k r^2) = (p0 X + p1 Y + p2) / (1 + p3 X + p4 Y)` with right coordinates
/// `(X, Y) = (x, y) (1 + k r^2)`: the views are taken through a lens with a radial distortion, both of them or one. Without
/// distortion, `k = 0`, it is a [`super::RowModel`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Curve {
    /// `p2, p0, p1, p3, p4, k`: a simpler model frees fewer of them, from the first.
    pub parameters: [f64; MOST],
    /// 1 for the left and for the right view if the lens distorts that view, 0 if not.
    pub distorted: [f64; 2],
}

impl Curve {
    pub const AS_IS: Self = Self::undistorted([0.0, 1.0, 0.0, 0.0, 0.0]);

    /// The curve of a row model with the parameters `p0` to `p4`.
    pub const fn undistorted([p0, p1, p2, p3, p4]: [f64; 5]) -> Self {
        Self { parameters: [p2, p0, p1, p3, p4, 0.0], distorted: [1.0; 2] }
    }

    /// Row of the curve minus row of the left point.
    pub fn error(&self, point: &Point) -> f64 {
        self.linearised(point).0
    }

    /// The error and its derivatives by all parameters.
    fn linearised(&self, Point { left, right }: &Point) -> (f64, [f64; MOST]) {
        let [p2, p0, p1, p3, p4, k] = self.parameters;
        let [in_left, in_right] = self.distorted;
        let (left_square, right_square) = (in_left * left.length_squared(), in_right * right.length_squared());
        let [x, y] = (*right * (1.0 + k * right_square)).to_array();
        let below = 1.0 + p3 * x + p4 * y;
        let row = (p0 * x + p1 * y + p2) / below;
        let [by_x, by_y] = [(p0 - row * p3) / below, (p1 - row * p4) / below];
        let by_k = (by_x * right.x + by_y * right.y) * right_square - left.y * left_square;
        let slopes = [1.0 / below, x / below, y / below, -row * x / below, -row * y / below, by_k];
        (row - left.y * (1.0 + k * left_square), slopes)
    }

    /// Sum over all points of `ln(1 + (r / 0.3)^2)`, `r` being the error in pixels over the square root of 2, since
    /// either view has a part in it. `unit` is the unit of the points in pixels.
    pub fn cost(&self, points: &[Point], unit: f64) -> f64 {
        points.iter().map(|point| libm::log1p(deviation(self.error(point) * unit, PRECISION))).sum()
    }

    /// The curve of a vertical shift that puts the right point on the row of the left one.
    pub fn shift(point: &Point) -> Self {
        Self::undistorted([0.0, 1.0, point.left.y - point.right.y, 0.0, 0.0])
    }

    /// Gauss-Newton steps on the first `free` parameters with Cauchy weights, from wide to narrow (Huber, Robust
    /// Statistics, 1981); `None` if the points do not determine the parameters.
    pub fn refined(mut self, free: usize, points: &[Point], unit: f64) -> Option<Self> {
        for width in WIDTHS {
            for _ in 0..STEPS {
                let (mut normal, mut moment) = ([[0.0; MOST]; MOST], [0.0; MOST]);
                for point in points {
                    let (error, slopes) = self.linearised(point);
                    let weight = 1.0 / (1.0 + deviation(error * unit, width));
                    for i in 0..free {
                        moment[i] -= weight * slopes[i] * error;
                        for j in 0..=i {
                            normal[i][j] += weight * slopes[i] * slopes[j];
                        }
                    }
                }
                let step = solved(normal, moment, free, LEAST)?;
                self.parameters.iter_mut().zip(step).for_each(|(parameter, change)| *parameter += change);
                if step.iter().all(|change| change.abs() <= SETTLED) {
                    break;
                }
            }
        }
        self.parameters.iter().all(|value| value.is_finite()).then_some(self)
    }
}

/// Square of an error in pixels in units of `width`, as the error of one of two views.
fn deviation(error: f64, width: f64) -> f64 {
    error * error / (2.0 * width * width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_error() {
        let parameters = [0.02, 0.1, 0.95, 0.08, -0.05, -0.15];
        let point = Point { left: DVec2::new(0.6, -0.4), right: DVec2::new(0.45, -0.5) };
        for distorted in [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]] {
            let curve = Curve { parameters, distorted };
            let (_, slopes) = curve.linearised(&point);
            for (i, slope) in slopes.into_iter().enumerate() {
                let moved = |by: f64| {
                    let mut curve = curve;
                    curve.parameters[i] += by;
                    curve.error(&point)
                };
                let measured = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                assert!((measured - slope).abs() < 1e-8, "parameter {i}, {distorted:?}");
            }
        }
    }
}
