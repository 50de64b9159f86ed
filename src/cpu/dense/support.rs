//! Support by neighbouring disparities, from the definition.

use crate::{
    dense::{
        Dense,
        kernels::{SUPPORT_RADIUS, SUPPORT_TOLERANCE},
    },
    disparity::NONE,
    image::{Plane, Size},
};

/// Keeps the disparities that at least `least` pixels of their window share, the centre included. The confidence
/// becomes 1 + 5 (number of supporters - 1), plus up to 4 for the previous confidence, minus an eighth of the
/// photometric `residuals` of the 5x5 window; at least 1.
pub fn support(dense: &Dense, residuals: &Plane<u8>, least: u32) -> Dense {
    let Size { width, height } = dense.disparity.size();
    let radius = SUPPORT_RADIUS as i64;
    let mut out = dense.clone();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let disparity = dense.disparity.get(x, y);
        let shares = |(i, j): (i64, i64)| {
            let (column, row) = (i64::from(x) + i, i64::from(y) + j);
            let inside = (0..i64::from(width)).contains(&column) && (0..i64::from(height)).contains(&row);
            inside && {
                let other = dense.disparity.get(column as u32, row as u32);
                other != NONE && (i64::from(other) - i64::from(disparity)).abs() <= SUPPORT_TOLERANCE.into()
            }
        };
        let window = (-radius..=radius).flat_map(|j| (-radius..=radius).map(move |i| (i, j)));
        let count = window.filter(|&at| shares(at)).count();
        if disparity == NONE || count < least as usize {
            out.disparity.set(x, y, NONE);
            out.confidence.set(x, y, 0);
        } else {
            let margin = (5 * usize::from(dense.confidence.get(x, y))) >> 8;
            let around = |y: u32| (-2..=2).map(move |i| (i64::from(x) + i, y));
            let rows = y.saturating_sub(2)..=(y + 2).min(height - 1);
            let inside = rows.flat_map(around).filter(|(column, _)| (0..i64::from(width)).contains(column));
            let unlike: usize = inside.map(|(column, row)| usize::from(residuals.get(column as u32, row))).sum();
            out.confidence.set(x, y, (5 * count - 4 + margin).saturating_sub(unlike / 8).max(1) as u8);
        }
    }
    out
}
