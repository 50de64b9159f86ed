//! The plane, or the turn on the spot, that explains most points.

use glam::{DMat3, DVec2};

use super::{linear::null_space, minimise::minimise, sample::Samples};
use crate::rectify::Correspondence;

/// Number of samples of four points.
const SAMPLES: usize = 1000;
/// Number of points on which candidates are tested, the first ones.
const TRIED: usize = 800;

/// The homography from the left to the right view that most points agree with, to within `limit`; `None` if they determine
/// none.
pub(super) fn consensus(points: &[Correspondence], limit: f64) -> Option<DMat3> {
    let tried = &points[..points.len().min(TRIED)];
    let mut best: Option<(f64, DMat3)> = None;
    for four in Samples::<4>::of(points.len()).take(SAMPLES) {
        let Some(found) = through(four.map(|index| points[index])) else { continue };
        let cost = tried.iter().map(|point| (distance(&found, point) / limit).powi(2).min(1.0)).sum();
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, found));
        }
    }
    let start = best?.1;
    let scale = start.z_axis.z;
    let start = if scale.abs() > 1e-9 { start * (1.0 / scale) } else { start };
    let matrix = |&[a, b, c, d, e, f, g, h]: &[f64; 8]| DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, 0.0]) + start;
    let near: Vec<&Correspondence> = points.iter().filter(|point| distance(&start, point) <= 2.0 * limit).collect();
    let found = minimise([0.0; 8], |parameters, errors| {
        let found = matrix(parameters);
        errors.robust.extend(near.iter().flat_map(|point| {
            let off = projected(&found, point.left) - point.right;
            (off / (0.5 * limit)).to_array()
        }));
    });
    Some(matrix(&found.parameters))
}

/// Distance of the right point from where `map` takes the left one; infinite for the horizon.
pub(super) fn distance(map: &DMat3, point: &Correspondence) -> f64 {
    let off = projected(map, point.left) - point.right;
    if off.is_finite() { off.length() } else { f64::INFINITY }
}

/// Where `map` takes a place, also from behind the picture.
pub(super) fn projected(map: &DMat3, place: DVec2) -> DVec2 {
    let there = *map * place.extend(1.0);
    there.truncate() / there.z
}

/// The homography of four points.
fn through(points: [Correspondence; 4]) -> Option<DMat3> {
    let mut rows = [[0.0; 9]; 8];
    for (pair, Correspondence { left: DVec2 { x, y }, right }) in rows.as_chunks_mut::<2>().0.iter_mut().zip(points) {
        pair[0] = [x, y, 1.0, 0.0, 0.0, 0.0, -right.x * x, -right.x * y, -right.x];
        pair[1] = [0.0, 0.0, 0.0, x, y, 1.0, -right.y * x, -right.y * y, -right.y];
    }
    let [found] = null_space::<8, 9, 1>(rows)?;
    Some(DMat3::from_cols_array(&found).transpose())
}
