//! The layout of volumes with a range of disparities per cell. `shaders/shared/cell_layout.wgsl`.

use std::ops::Range;

use crate::{
    dense::pyramid::{CellTable, SIDE},
    error::Result,
    gpu::{Gpu, ROW_BITS, WordTexture},
    image::Size,
};

/// Words of a step of a pixel's number of words.
pub(super) const GRAIN: u32 = 4;

/// Where the words of each pixel are in the volume of its band, on the device.
#[derive(Clone, Debug)]
pub struct CellLayout {
    pub(super) words: WordTexture,
    pub(super) columns: u32,
    pub(super) cells: u32,
    /// The most words of a pixel.
    pub(super) most_words: u32,
    /// Words of each row of pixels.
    row_words: Vec<u32>,
}

/// A band of rows of a level, whose volumes have a range of disparities per cell.
#[derive(Clone, Copy, Debug)]
pub struct LevelBand<'a> {
    /// The layout of the volumes of all bands.
    pub layout: &'a CellLayout,
    /// Width of the level, in pixels.
    pub width: u32,
    /// First row of the band in the level.
    pub top: u32,
    /// First row of the band in the census transforms.
    pub first_row: u32,
    /// Rows of the band.
    pub rows: u32,
}

impl CellLayout {
    /// Uploads the layout of `table` in `bands` of rows, which cover the level.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn new(gpu: &Gpu, table: &CellTable, bands: &[Range<u32>]) -> Result<Self> {
        let Size { width, height } = table.size;
        let row_words = row_words(table);
        let mut words = Vec::new();
        for band in bands {
            let mut start = 0;
            for row in band.clone() {
                words.push(start);
                start += row_words[row as usize];
            }
        }
        for row in 0..table.cells.height() {
            let mut start = 0;
            for (column, cell) in (0..).zip(table.cells.row(row)) {
                words.extend([start, cell.first << 16 | cell.words]);
                start += cell.words * SIDE.min(width - SIDE * column);
            }
        }
        let texture = WordTexture::new(gpu, "layout of the cells", words.len() as u64)?;
        texture.write(gpu, words);
        let most_words = table.cells.data().iter().map(|cell| cell.words).max().unwrap_or(0);
        Ok(Self { words: texture, columns: table.cells.width(), cells: height, most_words, row_words })
    }

    /// Words of `rows` of the level.
    pub fn words_of(&self, rows: Range<u32>) -> u64 {
        self.row_words[rows.start as usize..rows.end as usize].iter().map(|&words| u64::from(words)).sum()
    }
}

/// Words of each row of pixels.
pub(in crate::dense) fn row_words(table: &CellTable) -> Vec<u32> {
    (0..table.size.height).map(|y| table.row_words(y) as u32).collect()
}

/// Constants of `cell_layout.wgsl`.
pub(super) fn layout_constants() -> [(&'static str, i64); 2] {
    [("CELL_BITS", SIDE.ilog2().into()), ("ROW_BITS", ROW_BITS.into())]
}
