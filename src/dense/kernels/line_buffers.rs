//! The memory of kernels that follow lines.

/// The volumes and the view of a path through a band.
#[derive(Clone, Copy, Debug)]
pub struct LineBuffers<'b> {
    /// The reference view, as [`super::Census`] leaves it.
    pub reference: &'b wgpu::Buffer,
    /// The matching costs of the band.
    pub costs: &'b wgpu::Buffer,
    /// The stored paths, one volume each.
    pub paths: &'b wgpu::Buffer,
}

/// Where the volumes of the stored paths stand, in words.
#[derive(Clone, Copy, Debug)]
pub struct PathVolumes {
    /// The band's first row in the first path's volume.
    pub start: u32,
    /// From one path's volume to the next.
    pub volume_words: u32,
}
