//! The cells of a picture, each with disparities of its own to search.

use crate::{
    dense::config::{DenseConfig, DenseParameters},
    disparity::{DisparityRange, SCALE},
    gpu::{Gpu, buffer_of},
    image::Size,
};

/// The side of a cell in pixels.
pub const CELL: u32 = 16;

/// Pixels around a cell that have a say in what is searched there.
pub const REACH: u32 = 8;

/// How the ranges of cells lie in their buffer: two words each, the index of the first disparity and how many
/// there are, row by row.
#[derive(Clone, Debug)]
pub struct Ranges {
    pub(in crate::dense) buffer: wgpu::Buffer,
    /// A cell's side is two to the power of this.
    pub(in crate::dense) shift: u32,
    pub(in crate::dense) columns: u32,
}

impl Ranges {
    /// One range for all pixels.
    pub fn whole(gpu: &Gpu, range: DisparityRange) -> Self {
        let words = [0, range.count];
        let buffer = buffer_of(gpu, "the whole range", bytemuck::bytes_of(&words), wgpu::BufferUsages::STORAGE);
        Self { buffer, shift: 31, columns: 1 }
    }

    /// A range for each cell of a picture of this width, in `buffer`.
    pub fn of_cells(buffer: wgpu::Buffer, width: u32) -> Self {
        Self { buffer, shift: CELL.ilog2(), columns: width.div_ceil(CELL) }
    }
}

/// A band of cells, and the part of a map of half the size that they look at.
#[derive(Clone, Copy, Debug)]
pub struct CellBand {
    /// Cells in a row.
    pub columns: u32,
    /// Rows of cells.
    pub rows: u32,
    /// The disparities of which each cell gets a part.
    pub range: DisparityRange,
    /// Where the first cell lies in the rows of the map.
    pub(in crate::dense) map_start: i32,
    /// The first row of the map that is looked at.
    pub map_first_row: u32,
    /// The rows of the map that are looked at.
    pub map_rows: u32,
    /// Width of the map.
    pub map_width: u32,
    /// The disparities that are searched for the map.
    pub map_range: DisparityRange,
}

impl CellBand {
    /// The cells of `rows` rows from `first_row` on, a multiple of [`CELL`], of a picture of `size`.
    pub fn new(Size { width, height }: Size, (first_row, rows): (u32, u32), range: DisparityRange) -> Self {
        let rows = rows.div_ceil(CELL);
        let map_first_row = (first_row / 2).saturating_sub(REACH / 2);
        let map_end = ((first_row + rows * CELL + REACH) / 2).min(height.div_ceil(2));
        Self {
            columns: width.div_ceil(CELL),
            rows,
            range,
            map_start: (first_row / 2) as i32 - map_first_row as i32,
            map_first_row,
            map_rows: map_end - map_first_row,
            map_width: width.div_ceil(2),
            map_range: halved(range),
        }
    }

    /// Words of the ranges' buffer.
    pub fn words(&self) -> u64 {
        2 * u64::from(self.columns) * u64::from(self.rows)
    }
}

/// What a whole disparity at half the size stands for on either side, in 1/256 px of the whole one: no odd disparity is
/// closer to twice a whole one.
pub(crate) const HALF_GRAIN: u32 = SCALE as u32;

/// How a pair of half the size is matched to find what to search: unconfirmed, since what the other view says of it
/// confirms the matches of the whole size.
pub(crate) fn halved_config(config: &DenseConfig, range: DisparityRange) -> DenseConfig {
    let unconfirmed = |parameters: &mut DenseParameters| {
        parameters.consistency = None;
        parameters.refinement = None;
    };
    DenseConfig { range: halved(range), ..config.clone().with(unconfirmed) }
}

/// The disparities of a pair of half the size that correspond to `range`.
fn halved(range: DisparityRange) -> DisparityRange {
    let min = range.min.div_euclid(2);
    DisparityRange { min, count: (-(-range.last()).div_euclid(2) - min + 1) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_the_size_holds_all_of_a_range() {
        for (min, count, expected) in
            [(0, 64, (0, 33)), (3, 1, (1, 2)), (-5, 5, (-3, 4)), (-1, 1, (-1, 2)), (4, 1, (2, 1))]
        {
            let range = halved(DisparityRange { min, count });
            assert_eq!((range.min, range.count), expected, "{count} from {min}");
        }
    }

    #[test]
    fn a_band_looks_at_its_surroundings() {
        let range = DisparityRange { min: 0, count: 10 };
        let band = CellBand::new(Size::new(100, 130), (64, 40), range);
        assert_eq!((band.columns, band.rows, band.words()), (7, 3, 42));
        // Rows 64 to 112 and 8 more around, halved.
        assert_eq!((band.map_first_row, band.map_rows, band.map_start), (28, 32, 4));
        assert_eq!(CellBand::new(Size::new(100, 130), (0, 32), range).map_start, 0);
    }
}
