//! A volume of costs with a range of disparities per cell.

use crate::{
    dense::pyramid::{CellTable, SIDE},
    image::Size,
};

/// One value per pixel and disparity of the pixel's cell, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellVolume {
    /// The disparities of the cells.
    pub table: CellTable,
    /// The values.
    pub values: Vec<u8>,
}

impl CellVolume {
    /// Where the values of each pixel begin, and behind the last pixel.
    pub fn starts(table: &CellTable) -> Vec<usize> {
        let Size { width, height } = table.size;
        let mut starts = vec![0];
        let mut end = 0;
        for y in 0..height {
            for x in 0..width {
                end += 4 * table.cells.get(x / SIDE, y / SIDE).words as usize;
                starts.push(end);
            }
        }
        starts
    }
}
