//! Lens distortion that a row model leaves unexplained.

use super::{
    curve::{Curve, MOST, Point},
    frame::{AGREEMENT, Frame},
};

/// Smallest and largest distortion that lenses have and matches tell, `k1` in `x_d = x_u (1 + k1 r^2)` with `r` in units
/// of the mean of width and height.
const DISTORTION: [f64; 2] = [-1.0, 0.5];
/// Number of points per side of the grid on which models are compared.
const GRID: u32 = 9;
/// Share of the inliers' disparities left out at either end.
const TAIL: f64 = 0.05;

/// Views that a lens distorts: both through the same lens, or one of two different cameras.
const DISTORTED: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];

/// Fits with the distortion of a lens, refined from `start`, if lenses have such a distortion.
pub(super) fn fits(start: &Curve, points: &[Point], frame: &Frame) -> impl Iterator<Item = Curve> {
    let half = frame.half();
    let is_of_a_lens = move |fit: &Curve| {
        let k1 = -fit.parameters[MOST - 1] * (half.x + half.y) * (half.x + half.y);
        (DISTORTION[0]..=DISTORTION[1]).contains(&k1)
    };
    let starts = DISTORTED.map(|distorted| Curve { parameters: start.parameters, distorted });
    starts.into_iter().filter_map(|start| start.refined(MOST, points, frame.unit)).filter(is_of_a_lens)
}

/// Largest row error of `curve` anywhere in the picture if `lens`, a fit with distortion, is right, in units of `frame`.
///
/// The error depends on the disparity, since a point appears in different parts of the two views: the disparities near
/// both ends of the inliers' are tried.
pub(super) fn effect(lens: &Curve, curve: &Curve, points: &[Point], frame: &Frame) -> f64 {
    let half = frame.half();
    let inlier = |point: &&Point| lens.error(point).abs() * frame.unit <= AGREEMENT;
    let mut disparities: Vec<f64> = points.iter().filter(inlier).map(|point| point.left.x - point.right.x).collect();
    disparities.sort_by(f64::total_cmp);
    let Some(last) = disparities.len().checked_sub(1) else { return 0.0 };
    let ends = [TAIL, 1.0 - TAIL].map(|share| disparities[(share * last as f64) as usize]);
    let step = |i: u32| 2.0 * f64::from(i) / f64::from(GRID - 1) - 1.0;
    let places = (0..GRID * GRID).map(|i| half * glam::DVec2::new(step(i % GRID), step(i / GRID)));
    let tried = places.flat_map(|right| ends.map(|disparity| (right, disparity)));
    tried
        .map(|(right, disparity)| {
            let on_row = Point { left: (right.x + disparity, 0.0).into(), right };
            Point { left: (on_row.left.x, curve.error(&on_row)).into(), right }
        })
        .filter(|point| point.left.x.abs() <= half.x)
        .map(|point| lens.error(&point).abs())
        .fold(0.0, f64::max)
}
