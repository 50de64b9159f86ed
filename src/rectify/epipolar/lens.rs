//! The distortion of the lens, from matches alone.

use glam::{DMat3, DVec2, DVec3};

use super::{
    frame::{Frame, PRECISION},
    fundamental::Fundamental,
    linear::{rotation, singular},
    minimise::minimise,
    rows,
};
use crate::rectify::Correspondence;

/// Error of the points that take part, in pixels: a distortion moves inliers.
const WITHIN: f64 = 3.0;
/// Distortions that are tried.
const TRIED: [f64; 13] = [-0.4, -0.35, -0.3, -0.25, -0.2, -0.15, -0.1, -0.05, 0.0, 0.05, 0.1, 0.15, 0.2];
/// Number of points that decide between them.
const FIRST: usize = 400;
/// Smallest fall of the cost for which a distortion is accepted, and its smallest share of the cost: without distortion the cost of
/// eight scenes fell by up to 1.9 and 0.8 %, with k1 = -0.2 by at least 12 and 5.9 %.
const FALL: (f64, f64) = (10.0, 0.04);

/// Radial distortion, the same in both views: `x_d = x_u (1 + k1 r^2)` with coordinates from the centre of the view, `r` in units
/// of the mean of its width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lens {
    pub k1: f64,
}

impl Lens {
    pub const NONE: Self = Self { k1: 0.0 };

    /// Where the lens shows an undistorted place, `unit` being the mean side of the view; `None` beyond the circle up to which the
    /// lens shows places further out further out.
    pub fn distorted(&self, place: DVec2, unit: f64) -> Option<DVec2> {
        let square = place.length_squared() / (unit * unit);
        (1.0 + 3.0 * self.k1 * square > 0.0).then(|| place * (1.0 + self.k1 * square))
    }

    /// The place without distortion, by Newton's method, which approaches it from one side; for a place beyond what the lens can show,
    /// the closest.
    pub fn undistorted(&self, place: DVec2, unit: f64) -> DVec2 {
        const STEPS: usize = 12;
        /// Each step squares the error.
        const SETTLED: f64 = 1e-8;
        let distorted = place.length() / unit;
        if self.k1 == 0.0 || distorted == 0.0 {
            return place;
        }
        // Up to here the lens shows places further out further out, at two thirds of the radius.
        let end = if self.k1 < 0.0 { (-1.0 / (3.0 * self.k1)).sqrt() } else { f64::INFINITY };
        let mut radius = distorted;
        if distorted >= 2.0 / 3.0 * end {
            radius = end;
        } else {
            for _ in 0..STEPS {
                let slope = 1.0 + 3.0 * self.k1 * radius * radius;
                let step = (radius * (1.0 + self.k1 * radius * radius) - distorted) / slope;
                radius -= step;
                if step.abs() <= SETTLED * radius {
                    break;
                }
            }
        }
        place * (radius / distorted)
    }

    /// Points without distortion.
    pub fn straight(&self, points: &[Correspondence], frame: &Frame) -> Vec<Correspondence> {
        let [left, right] = [0, 1].map(|view| frame.mean_side(view));
        let straight = |point: &Correspondence| Correspondence {
            left: self.undistorted(point.left, left),
            right: self.undistorted(point.right, right),
        };
        points.iter().map(straight).collect()
    }

    /// The distortion that the points show; none unless it explains them clearly better than `start`, the fundamental matrix
    /// without distortion.
    pub fn shown(points: &[Correspondence], start: &Fundamental, frame: &Frame) -> Self {
        let near = start.inliers(points, WITHIN / frame.unit);
        let fit = |k1: f64, points: &[Correspondence]| {
            let straight = Self { k1 }.straight(points, frame);
            let found = start.refined(&straight, frame.unit)?;
            let cost = found.cost(&straight, frame.unit);
            cost.is_finite().then_some((cost, k1, found))
        };
        let Some((plain, ..)) = fit(0.0, &near) else { return Self::NONE };
        // The first ones are the most certain.
        let first = &near[..near.len().min(FIRST)];
        let tried = TRIED.into_iter().filter_map(|k1| fit(k1, first));
        let Some((_, k1, found)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return Self::NONE;
        };
        let (k1, cost) = refined(k1, &found, &near, frame);
        let accepted = plain - cost > FALL.0 && plain - cost > FALL.1 * plain;
        if accepted && TRIED[0] <= k1 && k1 <= TRIED[TRIED.len() - 1] { Self { k1 } } else { Self::NONE }
    }

    /// The distortion with rows that correspond but for a shift, as parallel cameras have them, if the points do not clearly show other
    /// rows; this one, found with `found`, otherwise. A perspective of the rows explains a part of a distortion, and the other way round.
    pub fn of_parallel_cameras(self, found: &Fundamental, points: &[Correspondence], frame: &Frame) -> Self {
        let straight = self.straight(points, frame);
        let within = WITHIN / frame.unit;
        let near: Vec<Correspondence> = points
            .iter()
            .zip(&straight)
            .filter(|(_, place)| found.error(place).abs() <= within)
            .map(|(p, _)| *p)
            .collect();
        let cost = found.cost(&self.straight(&near, frame), frame.unit);
        let level = minimise([0.0; 2], |&[k, shift], errors| {
            let rows = rows::fundamental([0.0, 1.0, shift, 0.0, 0.0]);
            let straight = Lens { k1: self.k1 + k }.straight(&near, frame);
            errors.robust.extend(straight.iter().map(|point| rows.error(point) * frame.unit / PRECISION));
        });
        let k1 = self.k1 + level.parameters[0];
        let is_tried = (TRIED[0]..=TRIED[TRIED.len() - 1]).contains(&k1);
        // Schwarz's criterion: a matrix has six parameters more than a shift.
        if is_tried && level.cost <= cost + 6.0 * libm::log(near.len() as f64) { Self { k1 } } else { self }
    }
}

/// Distortion and matrix refined together: the distortion, and the cost.
fn refined(k1: f64, start: &Fundamental, points: &[Correspondence], frame: &Frame) -> (f64, f64) {
    let (u, values, v) = singular(start.0);
    let angle = libm::atan2(values[1], values[0]);
    let found = minimise([0.0; 8], |&[a, b, c, d, e, f, t, k], errors| {
        let (sin, cos) = libm::sincos(angle + t);
        let middle = DMat3::from_diagonal(DVec3::new(cos, sin, 0.0));
        let (u, v) = (u * rotation(DVec3::new(a, b, c)), v * rotation(DVec3::new(d, e, f)));
        let matrix = Fundamental(u * middle * v.transpose());
        let straight = Lens { k1: k1 + k }.straight(points, frame);
        errors.robust.extend(straight.iter().map(|point| matrix.error(point) * frame.unit / PRECISION));
    });
    (k1 + found.parameters[7], found.cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_there_and_back_up_to_the_end_of_the_lens() {
        for k1 in [-0.4, -0.1, 0.2] {
            let lens = Lens { k1 };
            for radius in [0.0, 0.1, 0.5, 0.9] {
                let place = DVec2::new(0.6, -0.8) * radius;
                let back = lens.undistorted(lens.distorted(place, 1.0).unwrap(), 1.0);
                assert!((back - place).length() < 1e-6, "{k1}, {radius}: {back}");
            }
        }
        // The radius r (1 - 0.4 r^2) is largest at 1 / sqrt 1.2, and is 0.609 there.
        let lens = Lens { k1: -0.4 };
        assert_eq!(lens.distorted(DVec2::X, 1.0), None);
        for beyond in [0.61, 0.8, 3.0] {
            let closest = lens.undistorted(DVec2::Y * beyond, 1.0);
            assert!((closest - DVec2::Y / 1.2_f64.sqrt()).length() < 1e-9, "{beyond}: {closest}");
        }
    }
}
