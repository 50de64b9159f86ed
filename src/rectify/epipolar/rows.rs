//! Models of the rows: the left view stays as it is, and the rows of the right view are brought to it.

use glam::{DMat3, DVec2, DVec3};

use super::{
    frame::{Frame, PRECISION},
    fundamental::Fundamental,
    minimise::{Errors, SINGULAR, minimise},
};
use crate::rectify::{Correspondence, RowKind, cholesky::solved};

/// Widths of the Cauchy loss, in pixels, the widest first: the first one reaches what an affine start leaves of a perspective,
/// the last one is the precision of a match.
const WIDTHS: [f64; 5] = [30.0, 10.0, 3.0, 1.0, PRECISION];

/// Largest distance by which turn and scale may move columns that stay as they are, or turned by right angles, in pixels of the
/// detection.
const STAYS: f64 = 1.0;

/// The parameters `p0` to `p4` of a left row, `y = (p0 x + p1 y + p2) / (1 + p3 x + p4 y)`, in units of a frame.
pub(super) type Parameters = [f64; 5];

/// Rows as they are in the pictures, whose centres need not lie in one row.
pub(super) fn as_is(frame: &Frame) -> Parameters {
    [0.0, 1.0, frame.offset().y, 0.0, 0.0]
}

/// The fundamental matrix of views whose left rows are epipolar lines.
pub(super) fn fundamental([p0, p1, p2, p3, p4]: Parameters) -> Fundamental {
    Fundamental(DMat3::from_cols(DVec3::ZERO, DVec3::new(p3, p4, 1.0), -DVec3::new(p0, p1, p2)))
}

/// The homography of the right view that brings its rows to the left ones. Columns that turn and scale hardly move stay those of the
/// picture, or of the picture turned by right angles, so that nothing of their detail is lost; others follow from a turn and a scale alone
/// at the centre of the view, so that the surroundings of the centre are not sheared.
pub(super) fn homography(kind: RowKind, [p0, p1, p2, p3, p4]: Parameters, frame: &Frame) -> DMat3 {
    let turned = DVec2::new(p1, -p0).round();
    let moved = (DVec2::new(p1, -p0) - turned).abs().dot(frame.half(1));
    if kind <= RowKind::Affine && turned.length_squared() == 1.0 && moved * frame.unit <= STAYS {
        let offset = if turned == DVec2::X { frame.offset().x } else { 0.0 };
        return DMat3::from_cols(
            DVec3::new(turned.x, p0, 0.0),
            DVec3::new(turned.y, p1, 0.0),
            DVec3::new(offset, p2, 1.0),
        );
    }
    let (by_x, by_y) = (p0 - p2 * p3, p1 - p2 * p4);
    DMat3::from_cols(DVec3::new(by_y, p0, p3), DVec3::new(-by_x, p1, p4), DVec3::new(0.0, p2, 1.0))
}

/// Fits of a vertical shift, of affine and of projective rows.
pub(super) fn fits(points: &[Correspondence], unit: f64) -> impl Iterator<Item = (RowKind, Parameters)> {
    let shift = shift(points, unit);
    let affine = affine(points).map(|start| refined(start, [0, 1, 2], points, unit));
    let projective = affine.map(|start| refined(start, [0, 1, 2, 3, 4], points, unit));
    [
        shift.map(|fit| (RowKind::Shift, fit)),
        affine.map(|fit| (RowKind::Affine, fit)),
        projective.map(|fit| (RowKind::Projective, fit)),
    ]
    .into_iter()
    .flatten()
}

fn shift(points: &[Correspondence], unit: f64) -> Option<Parameters> {
    let mut shifts: Vec<f64> = points.iter().map(|point| point.left.y - point.right.y).collect();
    shifts.sort_by(f64::total_cmp);
    let median = *shifts.get(shifts.len() / 2)?;
    Some(refined([0.0, 1.0, median, 0.0, 0.0], [2], points, unit))
}

/// Least squares of the row differences.
fn affine(points: &[Correspondence]) -> Option<Parameters> {
    let (mut normal, mut moment) = ([[0.0; 3]; 3], [0.0; 3]);
    for Correspondence { left, right: DVec2 { x, y } } in points {
        let slopes = [*x, *y, 1.0];
        for i in 0..3 {
            moment[i] += slopes[i] * left.y;
            (0..3).for_each(|j| normal[i][j] += slopes[i] * slopes[j]);
        }
    }
    let [p0, p1, p2] = solved(normal, moment, 3, SINGULAR)?;
    Some([p0, p1, p2, 0.0, 0.0])
}

/// `start` with its `free` parameters refined.
fn refined<const N: usize>(start: Parameters, free: [usize; N], points: &[Correspondence], unit: f64) -> Parameters {
    let set = |values: &[f64; N]| {
        let mut parameters = start;
        free.iter().zip(values).for_each(|(&index, value)| parameters[index] = *value);
        parameters
    };
    let errors_of = |values: &[f64; N], errors: &mut Errors, width: f64| {
        let found = fundamental(set(values));
        errors.robust.extend(points.iter().map(|point| found.error(point) * unit / width));
    };
    let start = free.map(|index| start[index]);
    set(&WIDTHS
        .into_iter()
        .fold(start, |values, width| minimise(values, |values, errors| errors_of(values, errors, width)).parameters))
}
