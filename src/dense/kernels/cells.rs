//! The cells of a picture, each with its own range of disparities.

use crate::{
    dense::config::{DenseConfig, DenseParameters},
    disparity::{DisparityRange, SCALE},
    gpu::{Gpu, buffer_of},
    image::Size,
};

/// Side of a cell, in pixels.
pub const CELL: u32 = 16;

/// Halo of a cell, in pixels, which also determines its range.
pub const REACH: u32 = 8;

/// The ranges of cells in their buffer, row by row: per cell one `u32` for the index of the first disparity and one for
/// the number of disparities.
#[derive(Clone, Debug)]
pub struct Ranges {
    pub(in crate::dense) buffer: wgpu::Buffer,
    /// Base-2 logarithm of a cell's side, in pixels.
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

    /// One range per cell of a picture of `width` pixels, in `buffer`.
    pub fn of_cells(buffer: wgpu::Buffer, width: u32) -> Self {
        Self { buffer, shift: CELL.ilog2(), columns: width.div_ceil(CELL) }
    }
}

/// A band of cells, and the rows of the half-size map that they read.
#[derive(Clone, Copy, Debug)]
pub struct CellBand {
    /// Cells per row.
    pub columns: u32,
    /// Rows of cells.
    pub rows: u32,
    /// The searched disparities; each cell gets a part of them.
    pub range: DisparityRange,
    /// First row of the first cell, in rows from `map_first_row`.
    pub(in crate::dense) map_start: i32,
    /// First row of the half-size map that is read.
    pub map_first_row: u32,
    /// Rows of the half-size map that are read.
    pub map_rows: u32,
    /// Width of the half-size map, in pixels.
    pub map_width: u32,
    /// The searched disparities of the half-size map.
    pub map_range: DisparityRange,
}

impl CellBand {
    /// The cells of `rows` pixel rows from `first_row`, a multiple of [`CELL`], of a picture of `size`.
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

    /// Words of the buffer of ranges.
    pub fn words(&self) -> u64 {
        2 * u64::from(self.columns) * u64::from(self.rows)
    }
}

/// Uncertainty of a whole half-size disparity to either side, in 1/256 px of the full size: an odd disparity is 1 px
/// away from twice the nearest whole one.
pub(crate) const HALF_GRAIN: u32 = SCALE as u32;

/// The configuration of the half-size pair. Its matches are not confirmed, since the other view's half-size winners
/// confirm the full-size matches.
pub(crate) fn halved_config(config: &DenseConfig, range: DisparityRange) -> DenseConfig {
    let unconfirmed = |parameters: &mut DenseParameters| {
        parameters.consistency = None;
        parameters.agreement = 0;
        parameters.refinement = None;
    };
    DenseConfig { range: halved(range), ..config.clone().with(unconfirmed) }
}

/// The disparities of a half-size pair that correspond to `range`.
pub(crate) fn halved(range: DisparityRange) -> DisparityRange {
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
