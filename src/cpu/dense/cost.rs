//! The matching cost of each pixel and disparity, from the definition.

use std::ops::Range;

use rayon::prelude::*;

use super::{census, wide_census};
use crate::{
    dense::{Cost, MAX_COST, View, WEIGHT_BITS},
    disparity::DisparityRange,
    image::{Luma, Plane},
};

/// The census transforms of a view.
#[derive(Clone, Debug)]
pub struct Transforms {
    /// The census transforms.
    pub census: Plane<u32>,
    /// The wide census transforms, if the costs of weak texture need them.
    pub wide: Option<Plane<u32>>,
}

impl Transforms {
    /// The census transforms that `cost` needs.
    pub fn new(luma: &Luma, cost: &Cost) -> Self {
        Self { census: census(luma), wide: cost.weak_spread.map(|spread| wide_census(luma, spread)) }
    }

    /// The given rows.
    pub(super) fn cut(&self, rows: Range<u32>) -> Self {
        Self { census: self.census.cut(rows.clone()), wide: self.wide.as_ref().map(|wide| wide.cut(rows)) }
    }
}

/// The matching costs of each pixel of `reference`, padded to a multiple of 16 disparities; a pixel without a partner
/// is compared with the nearest pixel of the row. Texture counts as weak where both views have wide census transforms.
pub fn cost(views: [&Transforms; 2], view: View, cost: &Cost, range: DisparityRange) -> Vec<u8> {
    let size = views[0].census.size();
    let disparities = 0..DisparityRange::padded(range.count);
    let row_bytes = size.width as usize * disparities.len();
    let mut costs = vec![0; row_bytes * size.height as usize];
    costs.par_chunks_mut(row_bytes).zip(0..size.height).for_each(|(row, y)| {
        write_row(row, views, view, cost, (y, range.min), |_| disparities.clone());
    });
    costs
}

/// Writes the matching costs of the pixels of row `y`, each at its `disparities` from `min` px on.
pub(super) fn write_row(
    mut costs: &mut [u8],
    [reference, other]: [&Transforms; 2],
    view: View,
    cost: &Cost,
    (y, min): (u32, i32),
    disparities: impl Fn(u32) -> Range<u32>,
) {
    let at = |row: &[u32], x: i64| row[x.clamp(0, row.len() as i64 - 1) as usize];
    let luma = |word: u32| i64::from(word & 255);
    let gradient = |row: &[u32], x: i64| luma(at(row, x + 1)) - luma(at(row, x - 1));
    let hamming = |a: u32, b: u32| ((a ^ b) >> 8).count_ones();
    let (own, others) = (reference.census.row(y), other.census.row(y));
    let wide = reference.wide.as_ref().zip(other.wide.as_ref()).map(|(own, others)| (own.row(y), others.row(y)));
    for column in 0..reference.census.width() {
        let x = i64::from(column);
        let (a, slope) = (at(own, x), gradient(own, x));
        let weak = wide.filter(|(own, _)| at(own, x) & 255 != 0);
        let disparities = disparities(column);
        let of_pixel = costs.split_off_mut(..disparities.len()).expect("room for each pixel");
        for (place, index) in of_pixel.iter_mut().zip(disparities) {
            let disparity = i64::from(min) + i64::from(index);
            let partner = if view == View::Left { x - disparity } else { x + disparity };
            let b = at(others, partner);
            let change = slope.abs_diff(gradient(others, partner)) as u32;
            let texture = match weak {
                Some((own, others)) => cost.census * hamming(at(own, x), at(others, partner)),
                None => {
                    let difference = luma(a).abs_diff(luma(b)) as u32;
                    cost.census * hamming(a, b) + cost.difference.weight * difference.min(cost.difference.limit)
                }
            };
            let sum = texture + cost.gradient.weight * change.min(cost.gradient.limit);
            *place = (sum >> WEIGHT_BITS).min(MAX_COST) as u8;
        }
    }
}
