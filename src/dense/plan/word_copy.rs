//! Copies of words from the memory of a plan.

/// Words of a buffer that go elsewhere.
#[derive(Debug)]
pub(in crate::dense) struct WordCopy {
    pub(in crate::dense) from: wgpu::Buffer,
    pub(in crate::dense) from_word: u64,
    pub(in crate::dense) to: CopyTarget,
    pub(in crate::dense) to_word: u64,
    pub(in crate::dense) words: u64,
}

impl WordCopy {
    /// Records the copy, into `to`.
    pub(in crate::dense) fn record(&self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::Buffer) {
        encoder.copy_buffer_to_buffer(&self.from, 4 * self.from_word, to, 4 * self.to_word, Some(4 * self.words));
    }
}

/// Where words go.
#[derive(Debug)]
pub(in crate::dense) enum CopyTarget {
    /// To a buffer of the plan.
    Buffer(wgpu::Buffer),
    /// To the caller's disparities, a word a pixel.
    Disparities,
    /// To the caller's confidences, four a word.
    Confidences,
}
