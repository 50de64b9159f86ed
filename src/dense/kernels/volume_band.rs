//! A band of rows of a volume: one value per pixel and disparity.

use crate::disparity::DisparityRange;

/// Rows of the census transforms and the disparities of their pixels. A volume holds 8-bit values, four packed per
/// `u32`; the words of a pixel, a multiple of four, are contiguous, pixel by pixel.
#[derive(Clone, Copy, Debug)]
pub struct VolumeBand {
    /// Width of both views, in pixels.
    pub width: u32,
    /// First row of the band in the census transforms.
    pub first_row: u32,
    /// Rows of the band.
    pub rows: u32,
    /// The searched disparities.
    pub range: DisparityRange,
}

impl VolumeBand {
    /// Words per pixel.
    pub fn words(&self) -> u32 {
        DisparityRange::padded(self.range.count) / 4
    }

    /// Bytes that a path reads and writes on its way: matching costs, path costs, and the transforms of the reference view.
    pub(super) fn followed_bytes(&self) -> u64 {
        let transforms = 8 * u64::from(self.width);
        u64::from(self.rows) * (2 * 4 * u64::from(self.row_words()) + transforms)
    }

    /// Values of the band: one per pixel and disparity.
    pub(super) fn values(&self) -> u64 {
        4 * u64::from(self.rows) * u64::from(self.row_words())
    }

    /// Words per row.
    pub fn row_words(&self) -> u32 {
        self.width * self.words()
    }
}
