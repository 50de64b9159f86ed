//! A map on the device: disparities, and behind them their confidences.

/// Where the parts of a map stand in their buffer: one disparity per pixel, then one confidence per pixel, four per word
/// and each row in words of its own, then, where a selection leaves them, one key per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapLayout {
    /// Pixels of a row.
    pub width: u32,
    /// Rows that there is room for.
    pub rows: u32,
}

impl MapLayout {
    /// Disparities.
    pub fn pixels(&self) -> u32 {
        self.width * self.rows
    }

    /// The word of the first confidence.
    pub fn confidence_offset(&self) -> u32 {
        self.pixels()
    }

    /// The word of the first key.
    pub fn key_offset(&self) -> u32 {
        self.words() as u32
    }

    /// Words of the disparities and the confidences.
    pub fn words(&self) -> u64 {
        u64::from(self.pixels()) + u64::from(self.rows) * u64::from(self.width.div_ceil(4))
    }
}

/// A map in a storage buffer.
#[derive(Clone, Copy, Debug)]
pub struct MapBuffer<'b> {
    /// The buffer.
    pub buffer: &'b wgpu::Buffer,
    /// Where the parts of the map stand.
    pub layout: MapLayout,
}
