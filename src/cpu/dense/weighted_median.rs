//! The weighted median of a map, from the definition.

use rayon::prelude::*;

use crate::{
    dense::Median,
    disparity::{DisparityMap, NONE},
    image::{Luma, Plane, Size},
};

/// The weight of a neighbour: 256 / 2^(difference / 2^halving_bits), interpolated between whole powers.
fn weight(difference: u8, halving_bits: u32) -> u32 {
    let sixteenths = (u32::from(difference) << 4) >> halving_bits;
    ((32 - sixteenths % 16) * 8).checked_shr(sixteenths / 16).unwrap_or(0)
}

/// Replaces each disparity by the weighted median of its window: the smallest disparity such that those up to it have
/// at least half of the total weight. With `median.holes_only`, only pixels without disparity in `before` change.
pub fn weighted_median(luma: &Luma, disparities: &DisparityMap, before: &DisparityMap, median: Median) -> DisparityMap {
    let Size { width, height } = disparities.size();
    let radius = i64::from(median.radius);
    let filtered = |x: u32, y: u32| {
        let own = disparities.get(x, y);
        if own == NONE || median.holes_only && before.get(x, y) != NONE {
            return own;
        }
        let columns = (i64::from(x) - radius).max(0)..=(i64::from(x) + radius).min(i64::from(width) - 1);
        let rows = (i64::from(y) - radius).max(0)..=(i64::from(y) + radius).min(i64::from(height) - 1);
        let window = rows.flat_map(|row| columns.clone().map(move |column| (column as u32, row as u32)));
        let mut entries: Vec<(i32, u32)> = window
            .map(|(column, row)| {
                let difference = luma.get(column, row).abs_diff(luma.get(x, y));
                (disparities.get(column, row), weight(difference, median.halving_bits))
            })
            .filter(|&(disparity, weight)| disparity != NONE && weight > 0)
            .collect();
        entries.sort_unstable();
        let total: u32 = entries.iter().map(|&(_, weight)| weight).sum();
        let mut below = 0;
        let median = entries.iter().find(|&&(_, weight)| {
            below += weight;
            2 * below >= total
        });
        median.map_or(own, |&(disparity, _)| disparity)
    };
    let rows: Vec<Vec<i32>> =
        (0..height).into_par_iter().map(|y| (0..width).map(|x| filtered(x, y)).collect()).collect();
    Plane::from_fn((width, height), |x, y| rows[y as usize][x as usize])
}
