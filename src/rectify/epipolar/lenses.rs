//! The distortions of the lenses of both views, from matches alone.

use super::{
    frame::{Frame, PRECISION},
    fundamental::Fundamental,
    lens::Lens,
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
/// Magnitude of both distortions from which two of opposite senses are not accepted. A lens whose centre lies off the middle of its view, as
/// of a cropped picture, looks so, and five such pairs had 27 to 36 % of the map wrong. A barrel and a pincushion lens are rarely a pair.
const OPPOSITE: f64 = 0.06;
/// Widths of the Cauchy loss from which two lenses are found, in pixels, the widest first.
const WIDTHS: [f64; 3] = [3.0, 1.0, PRECISION];
/// Number of times that points are chosen and two lenses refined: without them, points far from the centre are no inliers.
const ROUNDS: usize = 3;

/// The radial distortions of the left and of the right view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lenses(pub [Lens; 2]);

/// Lenses, the matrix of places without their distortion, and the cost.
#[derive(Clone, Copy, Debug)]
struct Fit {
    lenses: Lenses,
    matrix: Fundamental,
    cost: f64,
}

impl Lenses {
    pub const NONE: Self = Self::of([0.0; 2]);

    pub const fn of([left, right]: [f64; 2]) -> Self {
        Self([Lens { k1: left }, Lens { k1: right }])
    }

    pub const fn k1(&self) -> [f64; 2] {
        [self.0[0].k1, self.0[1].k1]
    }

    /// Points without distortion.
    pub fn straight(&self, points: &[Correspondence], frame: &Frame) -> Vec<Correspondence> {
        let ([left, right], [of_left, of_right]) = (self.0, [0, 1].map(|view| frame.mean_side(view)));
        let straight = |point: &Correspondence| Correspondence {
            left: left.undistorted(point.left, of_left),
            right: right.undistorted(point.right, of_right),
        };
        points.iter().map(straight).collect()
    }

    /// The distortions that the points show: that of one lens unless two explain them clearly better, and none unless one explains
    /// them clearly better than `start`, the fundamental matrix without distortion.
    pub fn shown(points: &[Correspondence], start: &Fundamental, frame: &Frame) -> Self {
        let near = start.inliers(points, WITHIN / frame.unit);
        // The first ones are the most certain.
        let first = &near[..near.len().min(FIRST)];
        let fit = |k1: f64, points: &[Correspondence]| Fit::without_more(Self::of([k1; 2]), start, points, frame);
        let Some(plain) = fit(0.0, &near) else { return Self::NONE };
        let tried = TRIED.into_iter().filter_map(|k1| fit(k1, first));
        let Some(one) = tried.min_by(|a, b| a.cost.total_cmp(&b.cost)) else {
            return Self::NONE;
        };
        let one = one.refined::<8>(&near, PRECISION, frame);
        let one = if one.is_better_than(&plain) && one.lenses.are_tried() { one } else { plain };
        one.of_two_lenses(points, frame).unwrap_or(one).lenses
    }

    /// The distortions with rows that correspond but for a shift, as parallel cameras have them, if the points do not clearly show
    /// other rows; these ones, found with `found`, otherwise. A perspective of the rows explains a part of a distortion, and the other
    /// way round.
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
        let (level, least) = match self.0[0] == self.0[1] {
            true => self.with_level_rows::<2>(&near, frame),
            false => self.with_level_rows::<3>(&near, frame),
        };
        // Schwarz's criterion: a matrix has six parameters more than a shift.
        if level.are_tried() && least <= cost + 6.0 * libm::log(near.len() as f64) { level } else { self }
    }

    /// The distortions refined with rows that correspond but for a shift, and the cost: `N` parameters, the shift first.
    fn with_level_rows<const N: usize>(self, points: &[Correspondence], frame: &Frame) -> (Self, f64) {
        let found = minimise([0.0; N], |parameters, errors| {
            let rows = rows::fundamental([0.0, 1.0, parameters[0], 0.0, 0.0]);
            let straight = self.moved(&parameters[1..]).straight(points, frame);
            errors.robust.extend(straight.iter().map(|point| rows.error(point) * frame.unit / PRECISION));
        });
        (self.moved(&found.parameters[1..]), found.cost)
    }

    /// The distortions moved by one number, or by one for each lens.
    fn moved(&self, by: &[f64]) -> Self {
        let [left, right] = self.k1();
        Self::of([left + by[0], right + by[by.len() - 1]])
    }

    /// Whether no lens has a distortion beyond those that are tried.
    fn are_tried(&self) -> bool {
        self.k1().iter().all(|k1| (TRIED[0]..=TRIED[TRIED.len() - 1]).contains(k1))
    }

    /// Whether the lenses distort in opposite senses, both notably.
    fn are_opposite(&self) -> bool {
        let [left, right] = self.k1();
        left * right < 0.0 && left.abs().min(right.abs()) > OPPOSITE
    }
}

impl Fit {
    /// The matrix of the points without the distortion of `lenses`, refined from `start`.
    fn without_more(lenses: Lenses, start: &Fundamental, points: &[Correspondence], frame: &Frame) -> Option<Self> {
        let straight = lenses.straight(points, frame);
        let matrix = start.refined(&straight, frame.unit)?;
        let cost = matrix.cost(&straight, frame.unit);
        cost.is_finite().then_some(Self { lenses, matrix, cost })
    }

    /// Matrix and distortions refined together, with a loss of a `width` in pixels: `N` parameters, those of the matrix first and then
    /// one for both lenses or for each.
    fn refined<const N: usize>(&self, points: &[Correspondence], width: f64, frame: &Frame) -> Self {
        let matrices = self.matrix.around();
        let found = minimise([0.0; N], |parameters, errors| {
            let (of_matrix, of_lenses) = parameters.split_at(7);
            let matrix = matrices(of_matrix);
            let straight = self.lenses.moved(of_lenses).straight(points, frame);
            errors.robust.extend(straight.iter().map(|point| matrix.error(point) * frame.unit / width));
        });
        let (of_matrix, of_lenses) = found.parameters.split_at(7);
        Self { lenses: self.lenses.moved(of_lenses), matrix: matrices(of_matrix), cost: found.cost }
    }

    /// The fit of two lenses that differ, if they explain the points clearly better.
    fn of_two_lenses(&self, points: &[Correspondence], frame: &Frame) -> Option<Self> {
        let mut two = *self;
        for round in 0..ROUNDS {
            let near = two.near(points, frame);
            let first = &near[..near.len().min(FIRST)];
            two = WIDTHS.into_iter().fold(two, |two, width| two.refined::<9>(first, width, frame));
            // What one lens explains as well is that of one.
            if round == 0 && !two.is_better_than(&self.refined::<8>(first, PRECISION, frame)) {
                return None;
            }
        }
        let near = two.near(points, frame);
        let [one, two] = [self.refined::<8>(&near, PRECISION, frame), two.refined::<9>(&near, PRECISION, frame)];
        (two.is_better_than(&one) && two.lenses.are_tried() && !two.lenses.are_opposite()).then_some(two)
    }

    /// The points that agree with the fit, or nearly.
    fn near(&self, points: &[Correspondence], frame: &Frame) -> Vec<Correspondence> {
        let straight = self.lenses.straight(points, frame);
        let agrees = |place: &Correspondence| self.matrix.error(place).abs() * frame.unit <= WITHIN;
        points.iter().zip(&straight).filter(|(_, place)| agrees(place)).map(|(point, _)| *point).collect()
    }

    /// Whether the cost is clearly below that of a fit of the same points.
    fn is_better_than(&self, other: &Self) -> bool {
        let fall = other.cost - self.cost;
        fall > FALL.0 && fall > FALL.1 * other.cost
    }
}
