//! Keypoints as the kernels see them: a list that grows by an atomic counter.

use crate::{
    error::Result,
    gpu::{Binding, Gpu, ShaderType, shader_struct, storage_buffer},
};

shader_struct! {
    /// A maximum of the determinant, as found on the device; `shaders/shared/keypoint.wgsl`.
    #[derive(PartialEq)]
    pub struct Keypoint {
        /// Column in pixels.
        pub x: f32,
        /// Row in pixels.
        pub y: f32,
        /// Scale in pixels; 1.2 for the 9x9 filter.
        pub scale: f32,
        /// Radians, 0 to 2 pi; 0 until it is known, and in upright mode.
        pub orientation: f32,
        /// The response word of the sample: `determinant << 1 | (trace > 0)`.
        pub response: i32,
        /// The octave.
        pub octave: u32,
        /// The sample within its octave: `((layer - 1) * rows + row) * columns + column` of the grid.
        pub index: u32,
    }
}

impl Keypoint {
    /// What the final list is sorted by; no two keypoints of a picture share it.
    pub fn key(&self) -> (u32, u32) {
        (self.octave, self.index)
    }
}

/// Keypoints in a row of workgroups, where each has a workgroup of its own.
pub(crate) const DISPATCH_WIDTH: u32 = 256;

shader_struct! {
    /// Width and height of the picture, as `orientation.wgsl` and `descriptor.wgsl` declare them.
    pub(crate) struct Params {
        pub(crate) width: u32,
        pub(crate) height: u32,
    }
}

/// The uniform of `orientation.wgsl` and `descriptor.wgsl`.
pub(crate) const PARAMS: Binding = Binding::Uniform(Params::SHAPE);

/// Room for the keypoints of a picture, on the device, in buffers with `STORAGE`, `COPY_SRC` and `COPY_DST`.
#[derive(Debug)]
pub struct KeypointList {
    found: wgpu::Buffer,
    keypoints: wgpu::Buffer,
    capacity: u32,
}

impl KeypointList {
    /// Room for `capacity` of them.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device could not bind it.
    pub fn new(gpu: &Gpu, capacity: u32) -> Result<Self> {
        let bytes = u64::from(capacity) * size_of::<Keypoint>() as u64;
        Ok(Self {
            found: storage_buffer(gpu, "number of keypoints", size_of::<u32>() as u64)?,
            keypoints: storage_buffer(gpu, "keypoints", bytes)?,
            capacity,
        })
    }

    /// One word: how many were found, also where that is more than the capacity.
    pub fn found(&self) -> &wgpu::Buffer {
        &self.found
    }

    /// The [`Keypoint`]s, in no particular order.
    pub fn keypoints(&self) -> &wgpu::Buffer {
        &self.keypoints
    }

    /// How many there is room for.
    pub fn capacity(&self) -> u32 {
        self.capacity
    }
}
