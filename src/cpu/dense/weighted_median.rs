//! The weighted median of a map, from the definition.

use rayon::prelude::*;

use crate::{
    dense::Median,
    disparity::{DisparityMap, NONE},
    image::{Luma, Plane, Size},
};

/// The weight of a difference: 256 / 2^(difference / 2^halving_bits), interpolated between whole powers.
pub(super) fn halving_weight(difference: u32, halving_bits: u32) -> u32 {
    let sixteenths = (difference << 4) >> halving_bits;
    ((32 - sixteenths % 16) * 8).checked_shr(sixteenths / 16).unwrap_or(0)
}

/// The weighted median of disparities with weights: the smallest such that those up to it have at least half of the total
/// weight; `None` without any weight.
pub(super) fn least_with_half(mut weighted: Vec<(i32, u32)>) -> Option<i32> {
    weighted.retain(|&(_, weight)| weight > 0);
    weighted.sort_unstable();
    let total: u32 = weighted.iter().map(|&(_, weight)| weight).sum();
    let mut below = 0;
    let median = weighted.iter().find(|&&(_, weight)| {
        below += weight;
        2 * below >= total
    });
    median.map(|&(disparity, _)| disparity)
}

/// Replaces each disparity by the weighted median of its window.
pub fn weighted_median(luma: &Luma, disparities: &DisparityMap, median: Median) -> DisparityMap {
    let Size { width, height } = disparities.size();
    let radius = i64::from(median.radius);
    let filtered = |x: u32, y: u32| {
        let own = disparities.get(x, y);
        if own == NONE {
            return own;
        }
        let columns = (i64::from(x) - radius).max(0)..=(i64::from(x) + radius).min(i64::from(width) - 1);
        let rows = (i64::from(y) - radius).max(0)..=(i64::from(y) + radius).min(i64::from(height) - 1);
        let window = rows.flat_map(|row| columns.clone().map(move |column| (column as u32, row as u32)));
        let weighted = window
            .map(|(column, row)| {
                let difference = luma.get(column, row).abs_diff(luma.get(x, y));
                (disparities.get(column, row), halving_weight(difference.into(), median.halving_bits))
            })
            .filter(|&(disparity, _)| disparity != NONE);
        least_with_half(weighted.collect()).unwrap_or(own)
    };
    let rows: Vec<Vec<i32>> =
        (0..height).into_par_iter().map(|y| (0..width).map(|x| filtered(x, y)).collect()).collect();
    Plane::from_fn((width, height), |x, y| rows[y as usize][x as usize])
}
