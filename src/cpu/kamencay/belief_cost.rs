//! The data cost of belief propagation, from the definition.

use rayon::prelude::*;

use crate::{
    disparity::DisparityRange,
    image::Plane,
    kamencay::{FAR, Strip, WindowCost, kernels::MAX_DATA_COST},
};

/// The data costs of each pixel of a strip of `left`, padded with [`FAR`] to a multiple of four disparities. Both views
/// come from [`crate::kamencay::described`]; edge pixels are repeated outside.
pub fn belief_cost(
    [left, right]: [&Plane<u32>; 2],
    strip: Strip,
    cost: &WindowCost,
    range: DisparityRange,
) -> Vec<u16> {
    let radius = i64::from(cost.radius);
    let side = 2 * cost.radius + 1;
    // In 1/48 of a grey level. The columns of a window are clamped in each view separately.
    let difference = |x: i64, y: i64, disparity: i64| {
        let (a, b) = (left.get_clamped(x, y).to_le_bytes(), right.get_clamped(x - disparity, y).to_le_bytes());
        let channel = |channel: usize| u32::from(a[channel].abs_diff(b[channel]));
        let color = (channel(0) + channel(1) + channel(2)).min(3 * cost.color.limit);
        cost.color.weight * color + 3 * cost.gradient.weight * channel(3).min(cost.gradient.limit)
    };
    let costs_at = |pixel: u32| {
        let (x, y) = (i64::from(pixel % left.width()), i64::from(strip.first_row + pixel / left.width()));
        let of_disparity = move |index: u32| {
            if index >= range.count {
                return FAR as u16;
            }
            let disparity = i64::from(range.min) + i64::from(index);
            let window = (-radius..=radius).flat_map(|j| (-radius..=radius).map(move |i| (i, j)));
            let sum: u32 = window.map(|(i, j)| difference(x + i, y + j, disparity)).sum();
            (sum / (48 * side * side)).min(MAX_DATA_COST) as u16
        };
        (0..range.count.next_multiple_of(4)).map(of_disparity).collect::<Vec<u16>>()
    };
    (0..left.width() * strip.rows).into_par_iter().flat_map_iter(costs_at).collect()
}
