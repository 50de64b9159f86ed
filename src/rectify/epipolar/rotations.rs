//! Both views turned until their rows correspond.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec2, DVec3};

use super::{
    frame::{Frame, PRECISION, mapped},
    fundamental::Fundamental,
    linear::{cross, rotation},
    minimise::{Errors, minimise},
    shape::{area, grid, jacobian},
    similarity::Similarity,
};
use crate::rectify::Correspondence;

/// Standard deviation of pan and tilt, in radians.
const TILT: f64 = 8.0 * std::f64::consts::PI / 180.0;
/// The same of the base 3 logarithm of the focal length in units of width and height together.
const FOCAL: f64 = 0.35;
/// The same of the natural logarithm of the ratio of the focal lengths, around the ratio of scales that points show.
const RATIO: f64 = 0.05;
/// Width of the Cauchy loss of the principal points' offsets, in units of the larger side.
const OFFSET: f64 = 0.02;

/// Cosine of the turn from which a view lies on its side.
const UPRIGHT: f64 = 0.5;

/// Two cameras that see what the points show: rectifying rotations, and the calibrations that go with them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cameras {
    calibrations: [DMat3; 2],
    rotations: [DMat3; 2],
}

impl Cameras {
    /// The cameras of a vector of parameters: pan and roll of the left view, tilt, pan and roll of the right view, focal length,
    /// ratio of focal lengths, and principal points.
    fn of(
        &[left_y, left_z, right_x, right_y, right_z, focal, ratio, ref offsets @ ..]: &[f64; 11],
        frame: &Frame,
    ) -> Self {
        let left_focal = 2.0 * frame.mean_side(0) * libm::pow(3.0, focal);
        let calibration = |focal: f64, x: f64, y: f64| {
            DMat3::from_cols(DVec3::X * focal, DVec3::Y * focal, DVec3::new(2.0 * x, 2.0 * y, 1.0))
        };
        let [left_u, left_v, right_u, right_v] = *offsets;
        Self {
            calibrations: [
                calibration(left_focal, left_u, left_v),
                calibration(left_focal * libm::exp(ratio), right_u, right_v),
            ],
            rotations: [
                rotation(DVec3::Y * left_y) * rotation(DVec3::Z * left_z),
                rotation(DVec3::X * right_x) * rotation(DVec3::Y * right_y) * rotation(DVec3::Z * right_z),
            ],
        }
    }

    /// The cameras that agree with the points to their precision and are as close as possible to what cameras usually are: no pan and
    /// tilt, a common focal length, principal points in the centre. A Fusiello-Irsara rectification (Quasi-Euclidean epipolar
    /// rectification of uncalibrated images, Machine Vision and Applications 22, 2011) with priors on all parameters.
    pub fn fitted(points: &[Correspondence], frame: &Frame) -> Self {
        let Similarity { turn, scale } = Similarity::between(points);
        let growth = libm::log(scale);
        let errors = |parameters: &[f64; 11], errors: &mut Errors| {
            let fundamental = Self::of(parameters, frame).fundamental();
            errors.robust.extend(points.iter().map(|point| fundamental.error(point) * frame.unit / PRECISION));
            let [left_y, _, right_x, right_y, _, focal, ratio, ref offsets @ ..] = *parameters;
            errors.robust.extend(offsets.iter().map(|offset| offset / OFFSET));
            errors.plain.extend([left_y, right_x, right_y].map(|angle| angle / TILT));
            errors.plain.extend([focal / FOCAL, (ratio - growth) / RATIO]);
        };
        let starts = [0.0, FRAC_PI_2].map(|roll| {
            let mut start = [0.0; 11];
            (start[1], start[4], start[6]) = (roll, roll - turn, growth);
            minimise(start, errors)
        });
        let [upright, lying] = starts;
        Self::of(&if lying.cost < upright.cost { lying } else { upright }.parameters, frame)
    }

    /// The fundamental matrix.
    pub fn fundamental(&self) -> Fundamental {
        let [left, right] = [0, 1].map(|view| self.rotations[view] * self.calibrations[view].inverse());
        Fundamental(right.transpose() * cross(DVec3::X) * left)
    }

    /// The homographies of both views that bring corresponding points to equal rows: the rotations, with a common turn about the
    /// baseline that distorts areas least, a common calibration that keeps the area at the centre of the left view, and half a turn
    /// if the left view comes out upside down; if it lies on its side, for disparities of `points` above 0.
    pub fn homographies(&self, points: &[Correspondence], frame: &Frame) -> [DMat3; 2] {
        let maps = [0, 1].map(|view| self.rotations[view] * self.calibrations[view].inverse());
        let spread = |tilt: f64| area_spread(&maps.map(|map| rotation(DVec3::X * tilt) * map), frame);
        let tilt = least(spread, -0.6, 0.6);
        let mut maps = maps.map(|map| rotation(DVec3::X * tilt) * map);
        let down = jacobian(&maps[0], DVec2::ZERO)[1].normalize_or_zero();
        let is_upright = if down.y.abs() > UPRIGHT { down.y > 0.0 } else { is_left_on_the_left(&maps, points) };
        if !is_upright {
            maps = maps.map(|map| rotation(DVec3::Z * std::f64::consts::PI) * map);
        }
        let scale = DMat3::from_scale(DVec2::splat(1.0 / area(&maps[0], DVec2::ZERO).abs().sqrt()));
        maps.map(|map| scale * map)
    }
}

/// Whether most disparities are above 0.
fn is_left_on_the_left(maps: &[DMat3; 2], points: &[Correspondence]) -> bool {
    let column = |view: usize, place: DVec2| mapped(&maps[view], place).map(|place| place.x);
    let disparities = points.iter().filter_map(|point| Some(column(0, point.left)? - column(1, point.right)?));
    let (above, count) = disparities.fold((0, 0), |(above, count), d| (above + usize::from(d > 0.0), count + 1));
    2 * above >= count
}

/// Variance of the logarithm of areas all over both views; infinite for a view that reaches beyond the horizon.
fn area_spread(maps: &[DMat3; 2], frame: &Frame) -> f64 {
    let places = [0, 1].map(|view| grid(frame.half(view)).map(move |place| (view, place)));
    let logarithms: Vec<f64> = places
        .into_iter()
        .flatten()
        .map(|(view, place)| {
            let is_seen = mapped(&maps[view], place).is_some();
            if is_seen { libm::log(area(&maps[view], place).abs()) } else { f64::NAN }
        })
        .collect();
    let mean = logarithms.iter().sum::<f64>() / logarithms.len() as f64;
    let variance = logarithms.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>();
    if variance.is_finite() { variance } else { f64::INFINITY }
}

/// The place of the least of `value` between two places: the best of a coarse list, then by golden sections.
fn least(value: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const COARSE: u32 = 24;
    const STEPS: usize = 40;
    let step = (to - from) / f64::from(COARSE);
    let places = (0..=COARSE).map(|i| from + step * f64::from(i));
    let Some(best) = places.min_by(|&a, &b| value(a).total_cmp(&value(b))) else { return 0.0 };
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..STEPS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if value(a) <= value(b) { high = b } else { low = a }
    }
    (low + high) / 2.0
}
