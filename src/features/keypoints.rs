//! Keypoints as the kernels see them: a list that grows by an atomic counter.

use crate::{
    error::Result,
    gpu::{Binding, storage_buffer},
};

/// A maximum of the determinant, as found on the device.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Keypoint {
    /// Column in pixels.
    pub x: f32,
    /// Row in pixels.
    pub y: f32,
    /// Scale in pixels; 1.2 for the 9x9 filter.
    pub scale: f32,
    /// The response word of the sample: `determinant << 1 | (trace > 0)`.
    pub response: i32,
    /// The octave.
    pub octave: u32,
    /// The sample within its octave: `((layer - 1) * rows + row) * columns + column` of the grid.
    pub index: u32,
}

impl Keypoint {
    /// What the final list is sorted by; no two keypoints of a picture share it.
    pub fn key(&self) -> (u32, u32) {
        (self.octave, self.index)
    }
}

/// Bytes in front of the keypoints: their number.
pub const HEADER_BYTES: u64 = 4;

/// Keypoints in a row of workgroups, where each has a workgroup of its own.
pub(crate) const DISPATCH_WIDTH: u32 = 256;

/// Width and height of the picture, as `haar.wgsl` declares them.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Params {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// The uniform that `haar.wgsl` declares.
pub(crate) const PARAMS: Binding = Binding::Uniform(size_of::<Params>() as u64);

/// Bytes of a list with room for `capacity` keypoints.
pub fn list_bytes(capacity: u32) -> u64 {
    HEADER_BYTES + u64::from(capacity) * size_of::<Keypoint>() as u64
}

/// A list with room for `capacity` keypoints: their number in one word (which counts on when the
/// room is used up), then the [`Keypoint`]s in no particular order.
///
/// # Errors
/// [`crate::Error::TooLarge`] where the device could not bind it.
pub fn list_buffer(device: &wgpu::Device, capacity: u32) -> Result<wgpu::Buffer> {
    storage_buffer(device, "keypoints", list_bytes(capacity))
}
