//! A map on the device: disparities, then their confidences.

/// Layout of a map in its buffer: one disparity per pixel; then one confidence per pixel, four packed per `u32`, each
/// row in words of its own; then, if the selection writes keys, one key per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapLayout {
    /// Pixels per row.
    pub width: u32,
    /// Rows allocated.
    pub rows: u32,
}

impl MapLayout {
    /// Number of disparities.
    pub fn pixels(&self) -> u32 {
        self.width * self.rows
    }

    /// Offset of the first confidence, in words.
    pub fn confidence_offset(&self) -> u32 {
        self.pixels()
    }

    /// Offset of the first key, in words.
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
    /// Layout of the map in the buffer.
    pub layout: MapLayout,
}
