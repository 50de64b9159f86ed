//! Support by neighbouring disparities, from the definition.

use crate::{
    dense::{
        Dense, FILLED,
        kernels::{SUPPORT_RADIUS, SUPPORT_TOLERANCE},
    },
    disparity::NONE,
    image::{Plane, Size},
};

/// Keeps the disparities that at least `least` pixels of their window share, the centre included; with `majority`, half of
/// the window within the picture must have disparities that are at most twice the tolerance larger, too. The confidence becomes 1 + 5 (number of
/// supporters - 1), plus up to 4 for the previous confidence, minus an eighth of the photometric `residuals` of the 5x5
/// window; above [`FILLED`] at least.
pub fn support(dense: &Dense, residuals: &Plane<u8>, least: u32, majority: bool) -> Dense {
    let Size { width, height } = dense.disparity.size();
    let radius = SUPPORT_RADIUS as i64;
    let mut out = dense.clone();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let disparity = dense.disparity.get(x, y);
        let offsets = (-radius..=radius).flat_map(|j| (-radius..=radius).map(move |i| (i, j)));
        let window: Vec<i32> = offsets
            .map(|(i, j)| (i64::from(x) + i, i64::from(y) + j))
            .filter(|(column, row)| (0..width.into()).contains(column) && (0..height.into()).contains(row))
            .map(|(column, row)| dense.disparity.get(column as u32, row as u32))
            .collect();
        let nearer: Vec<i64> = window
            .iter()
            .filter(|&&other| other != NONE)
            .map(|&other| i64::from(other) - i64::from(disparity))
            .collect();
        let count = nearer.iter().filter(|difference| difference.abs() <= SUPPORT_TOLERANCE.into()).count();
        let not_nearer = nearer.iter().filter(|&&difference| difference <= (2 * SUPPORT_TOLERANCE).into()).count();
        let is_shared = !majority || 2 * not_nearer >= window.len();
        if disparity == NONE || count < least as usize || !is_shared {
            out.disparity.set(x, y, NONE);
            out.confidence.set(x, y, 0);
        } else {
            let margin = (5 * usize::from(dense.confidence.get(x, y))) >> 8;
            let around = |y: u32| (-2..=2).map(move |i| (i64::from(x) + i, y));
            let rows = y.saturating_sub(2)..=(y + 2).min(height - 1);
            let inside = rows.flat_map(around).filter(|(column, _)| (0..i64::from(width)).contains(column));
            let unlike: usize = inside.map(|(column, row)| usize::from(residuals.get(column as u32, row))).sum();
            out.confidence.set(
                x,
                y,
                (5 * count - 4 + margin).saturating_sub(unlike / 8).max(usize::from(FILLED) + 1) as u8,
            );
        }
    }
    out
}
