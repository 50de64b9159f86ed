//! The matching cost of each pixel at the disparities of its cell, from the definition.

use rayon::prelude::*;

use super::{Transforms, cell_volume::CellVolume, cost::write_row};
use crate::dense::{Cost, View, pyramid::CellTable};

/// The stage `cost` at the disparities of each pixel's cell.
pub fn cell_cost(views: [&Transforms; 2], view: View, cost: &Cost, table: &CellTable) -> CellVolume {
    let mut volume = CellVolume::empty(table);
    volume.rows_mut().into_par_iter().zip(0..table.size.height).for_each(|(row, y)| {
        write_row(row, views, view, cost, (y, table.range.min), |x| table.at(x, y).disparities());
    });
    volume
}
