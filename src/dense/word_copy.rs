//! Copies of `u32`s out of the buffers of a plan.

/// A copy of `words` `u32`s from a buffer. Offsets are in words.
#[derive(Debug)]
pub(super) struct WordCopy {
    pub(super) from: wgpu::Buffer,
    pub(super) from_word: u64,
    pub(super) to: CopyTarget,
    pub(super) to_word: u64,
    pub(super) words: u64,
}

impl WordCopy {
    /// Records the copy to buffer `to`.
    pub(super) fn record(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer) {
        encoder.copy_buffer_to_buffer(&self.from, 4 * self.from_word, to, 4 * self.to_word, Some(4 * self.words));
    }
}

/// The destination of a copy.
#[derive(Debug)]
pub(super) enum CopyTarget {
    /// A buffer of the plan.
    Buffer(wgpu::Buffer),
    /// The caller's disparities, one `i32` per pixel.
    Disparities,
    /// The caller's confidences, four packed per `u32`.
    Confidences,
}
