//! The mean cost over a square window, from the definition.

use crate::image::Size;
use rayon::prelude::*;

/// The mean of `costs` over the window of side `side` of each pixel of a picture of `size`, per disparity, in the
/// layout of `costs`: the mean along columns of the means along rows, both rounded to the nearest. Edge pixels are
/// repeated beyond the picture.
pub fn box_mean(costs: &[u8], size: Size, side: u32) -> Vec<u8> {
    mean_along(&mean_along(costs, size, side, (1, 0)), size, side, (0, 1))
}

fn mean_along(costs: &[u8], Size { width, height }: Size, side: u32, (dx, dy): (i64, i64)) -> Vec<u8> {
    let (width, height, side, radius) = (i64::from(width), i64::from(height), i64::from(side), i64::from(side / 2));
    let count = costs.len() / (width * height) as usize;
    let row = |y: i64| {
        (0..width).flat_map(move |x| {
            (0..count).map(move |d| {
                let cost = |step: i64| {
                    let (x, y) = ((x + step * dx).clamp(0, width - 1), (y + step * dy).clamp(0, height - 1));
                    i64::from(costs[(y * width + x) as usize * count + d])
                };
                let sum: i64 = (-radius..=radius).map(cost).sum();
                ((sum + side / 2) / side) as u8
            })
        })
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}
