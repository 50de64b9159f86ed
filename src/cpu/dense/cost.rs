//! The matching cost of each pixel and disparity, from the definition.

use std::ops::Range;

use rayon::prelude::*;

use super::{census, wide_census};
use crate::{
    dense::{Cost, MAX_COST, View, WEIGHT_BITS},
    disparity::DisparityRange,
    image::{Luma, Plane, Size},
};

/// The census transforms of a view.
#[derive(Clone, Debug)]
pub struct Transforms {
    /// From the stage `census`.
    pub census: Plane<u32>,
    /// From the stage `wide_census`, if weak texture has a cost of its own.
    pub wide: Option<Plane<u32>>,
}

impl Transforms {
    /// The census transforms that `cost` needs.
    pub fn new(luma: &Luma, cost: &Cost) -> Self {
        Self { census: census(luma), wide: cost.weak.map(|weak| wide_census(luma, weak.spread)) }
    }
}

/// The matching costs of each pixel of `reference`, padded to a multiple of four disparities; a pixel without a partner
/// is compared with the nearest pixel of the row. Texture counts as weak where both views have wide census transforms.
pub fn cost(views: [&Transforms; 2], view: View, cost: &Cost, range: DisparityRange) -> Vec<u8> {
    let Size { width, height } = views[0].census.size();
    let disparities = 0..range.count.next_multiple_of(4);
    let pixel = |x: u32, y: u32| costs_of_pixel(views, view, cost, (x, y), range.min, disparities.clone());
    (0..height).into_par_iter().flat_map_iter(|y| (0..width).flat_map(move |x| pixel(x, y))).collect()
}

/// The matching costs of pixel (`x`, `y`) at `disparities` from `min` px on.
pub(super) fn costs_of_pixel<'a>(
    [reference, other]: [&'a Transforms; 2],
    view: View,
    cost: &'a Cost,
    (x, y): (u32, u32),
    min: i32,
    disparities: Range<u32>,
) -> impl Iterator<Item = u8> + use<'a> {
    let x = i64::from(x);
    let at = move |plane: &Plane<u32>, x: i64| plane.get_clamped(x, i64::from(y));
    let luma = |word: u32| i64::from(word & 255);
    let gradient = move |plane: &Plane<u32>, x: i64| luma(at(plane, x + 1)) - luma(at(plane, x - 1));
    let hamming = |a: u32, b: u32| ((a ^ b) >> 8).count_ones();
    let (a, slope) = (at(&reference.census, x), gradient(&reference.census, x));
    let weak_texture = cost.weak.zip(reference.wide.as_ref()).zip(other.wide.as_ref());
    let weak = weak_texture.filter(|((_, wide), _)| at(wide, x) & 255 != 0);
    disparities.map(move |index| {
        let disparity = i64::from(min) + i64::from(index);
        let partner = if view == View::Left { x - disparity } else { x + disparity };
        let b = at(&other.census, partner);
        let distance = hamming(a, b);
        let change = slope.abs_diff(gradient(&other.census, partner)) as u32;
        let texture = match weak {
            Some(((weak, reference), other)) => {
                weak.census * distance + weak.wide_census * hamming(at(reference, x), at(other, partner))
            }
            None => {
                let difference = luma(a).abs_diff(luma(b)) as u32;
                cost.census * distance + cost.difference.weight * difference.min(cost.difference.limit)
            }
        };
        let sum = texture + cost.gradient.weight * change.min(cost.gradient.limit);
        (sum >> WEIGHT_BITS).min(MAX_COST) as u8
    })
}
