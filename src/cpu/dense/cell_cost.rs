//! The matching cost of each pixel at the disparities of its cell, from the definition.

use rayon::prelude::*;

use super::{Transforms, cell_volume::CellVolume, cost::costs_of_pixel};
use crate::{
    dense::{Cost, View, pyramid::CellTable},
    image::Size,
};

/// The stage `cost` at the disparities of each pixel's cell.
pub fn cell_cost(views: [&Transforms; 2], view: View, cost: &Cost, table: &CellTable) -> CellVolume {
    let Size { width, height } = table.size;
    let pixel =
        |x: u32, y: u32| costs_of_pixel(views, view, cost, (x, y), table.range.min, table.at(x, y).disparities());
    let values = (0..height).into_par_iter().flat_map_iter(|y| (0..width).flat_map(move |x| pixel(x, y))).collect();
    CellVolume { table: table.clone(), values }
}
