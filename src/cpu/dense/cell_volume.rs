//! A volume of costs with a range of disparities per cell.

use crate::{dense::pyramid::CellTable, image::Size};

/// One value per pixel and disparity of the pixel's cell, pixel by pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellVolume {
    /// The disparities of the cells.
    pub table: CellTable,
    /// The values.
    pub values: Vec<u8>,
}

impl CellVolume {
    /// A volume of zeros.
    pub fn empty(table: &CellTable) -> Self {
        let words: u64 = (0..table.size.height).map(|y| table.row_words(y)).sum();
        Self { table: table.clone(), values: vec![0; 4 * words as usize] }
    }

    /// The values of each row.
    pub fn rows_mut(&mut self) -> Vec<&mut [u8]> {
        let (table, mut rest) = (&self.table, &mut self.values[..]);
        let row = |y| rest.split_off_mut(..4 * table.row_words(y) as usize).expect("values of each row");
        (0..table.size.height).map(row).collect()
    }

    /// Where the values of each pixel begin, and behind the last pixel.
    pub fn starts(table: &CellTable) -> Vec<usize> {
        let Size { width, height } = table.size;
        let mut starts = vec![0];
        let mut end = 0;
        for y in 0..height {
            for x in 0..width {
                end += 4 * table.at(x, y).words as usize;
                starts.push(end);
            }
        }
        starts
    }
}
