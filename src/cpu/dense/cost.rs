//! The matching cost of each pixel and disparity, from the definition.

use rayon::prelude::*;

use crate::{
    dense::{Cost, MAX_COST, View, WEIGHT_BITS},
    disparity::DisparityRange,
    image::{Plane, Size},
};

/// The matching costs of each pixel of `reference`, padded to a multiple of four disparities. Both views come from
/// the stage `census`; a pixel without a partner is compared with the nearest pixel of the row.
pub fn cost([reference, other]: [&Plane<u32>; 2], view: View, cost: &Cost, range: DisparityRange) -> Vec<u8> {
    let Size { width, height } = reference.size();
    let at = |plane: &Plane<u32>, x: i64, y: u32| plane.get_clamped(x, i64::from(y));
    let luma = |word: u32| i64::from(word & 255);
    let gradient = |plane: &Plane<u32>, x: i64, y: u32| luma(at(plane, x + 1, y)) - luma(at(plane, x - 1, y));
    let row = |y: u32| {
        (0..i64::from(width)).flat_map(move |x| {
            let (a, slope) = (at(reference, x, y), gradient(reference, x, y));
            (0..range.count.next_multiple_of(4)).map(move |index| {
                let disparity = i64::from(range.min) + i64::from(index);
                let partner = if view == View::Left { x - disparity } else { x + disparity };
                let b = at(other, partner, y);
                let hamming = ((a ^ b) >> 8).count_ones();
                let difference = luma(a).abs_diff(luma(b)) as u32;
                let change = slope.abs_diff(gradient(other, partner, y)) as u32;
                let sum = cost.census * hamming
                    + cost.difference.weight * difference.min(cost.difference.limit)
                    + cost.gradient.weight * change.min(cost.gradient.limit);
                (sum >> WEIGHT_BITS).min(MAX_COST) as u8
            })
        })
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}
