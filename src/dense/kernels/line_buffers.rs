//! The buffers of the path kernels.

/// The buffers that a path reads and writes in a band.
#[derive(Clone, Copy, Debug)]
pub struct LineBuffers<'b> {
    /// The reference view, from [`super::Census`].
    pub reference: &'b wgpu::Buffer,
    /// The matching costs of the band.
    pub costs: &'b wgpu::Buffer,
    /// The volumes of the stored paths, one after the other.
    pub paths: &'b wgpu::Buffer,
}

/// The layout of the volumes of the stored paths, in words.
#[derive(Clone, Copy, Debug)]
pub struct PathVolumes {
    /// Offset of the band's first row in the first path's volume.
    pub start: u32,
    /// Distance from one path's volume to the next.
    pub volume_words: u32,
}
