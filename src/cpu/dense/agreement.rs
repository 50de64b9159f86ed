//! Agreement of neighbouring disparities, from the definition.

use crate::{
    dense::{
        Dense,
        kernels::{AGREEMENT_REACH, AGREEMENT_TOLERANCE},
    },
    disparity::NONE,
    image::Size,
};

/// Keeps the disparities that at least `least` of nine pixels share: the pixel itself and the eight pixels
/// [`AGREEMENT_REACH`] columns, rows, or both away. Pixels outside the map share none.
pub fn agreement(dense: &mut Dense, least: u32) {
    let before = dense.disparity.clone();
    let Size { width, height } = before.size();
    let reach = i64::from(AGREEMENT_REACH);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let disparity = before.get(x, y);
        let agrees = |&(dx, dy): &(i64, i64)| {
            let (column, row) = (i64::from(x) + dx, i64::from(y) + dy);
            let inside = (0..i64::from(width)).contains(&column) && (0..i64::from(height)).contains(&row);
            inside && {
                let other = before.get(column as u32, row as u32);
                other != NONE && (i64::from(other) - i64::from(disparity)).abs() <= AGREEMENT_TOLERANCE.into()
            }
        };
        let steps = [-reach, 0, reach];
        let around = steps.into_iter().flat_map(|dy| steps.map(|dx| (dx, dy)));
        if disparity != NONE && around.filter(agrees).count() < least as usize {
            dense.disparity.set(x, y, NONE);
            dense.confidence.set(x, y, 0);
        }
    }
}
