//! A band of rows of a volume: pixels times disparities.

use crate::disparity::DisparityRange;

/// Some rows of the transformed views, and the disparities of each of their pixels, four a word of eight bits each. A
/// pixel's words follow each other, then come the next pixel's.
#[derive(Clone, Copy, Debug)]
pub struct VolumeBand {
    /// Of the views.
    pub width: u32,
    /// Where the band begins among the rows of the transforms.
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
