//! A band of rows of a volume: pixels times disparities.

use crate::disparity::DisparityRange;

/// Rows `first_row` to `first_row + rows` of a picture, and the disparities of each of their pixels, four a word of eight
/// bits each. A pixel's words follow each other, then come the next pixel's.
#[derive(Clone, Copy, Debug)]
pub struct VolumeBand {
    /// Of the picture.
    pub width: u32,
    /// The first row.
    pub first_row: u32,
    /// How many rows.
    pub rows: u32,
    /// The disparities.
    pub range: DisparityRange,
}

impl VolumeBand {
    /// Words a pixel.
    pub fn words(&self) -> u32 {
        self.range.count.div_ceil(4)
    }

    /// Words a row.
    pub fn row_words(&self) -> u32 {
        self.width * self.words()
    }
}
