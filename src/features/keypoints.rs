//! Keypoints on the device: a list with an atomic counter.

use crate::{
    error::Result,
    gpu::{Binding, Gpu, ShaderType, shader_struct, storage_buffer},
};

shader_struct! {
    /// A maximum of the determinant, as the device writes it; `shaders/shared/keypoint.wgsl`.
    #[derive(PartialEq)]
    pub struct Keypoint {
        /// Column, in pixels.
        pub x: f32,
        /// Row, in pixels.
        pub y: f32,
        /// Scale, in pixels; 1.2 for the 9x9 filter.
        pub scale: f32,
        /// Orientation, in radians, 0 to 2 pi; 0 before the orientation stage and in upright mode.
        pub orientation: f32,
        /// Response of the sample: `determinant << 1 | (trace > 0)`.
        pub response: i32,
        /// Octave, from 0.
        pub octave: u32,
        /// Index of the sample in its octave: `((layer - 1) * rows + row) * columns + column` of the grid.
        pub index: u32,
    }
}

impl Keypoint {
    /// The sort key of the final list, unique within a picture.
    pub fn key(&self) -> (u32, u32) {
        (self.octave, self.index)
    }
}

/// Workgroups per row of a dispatch with one workgroup per keypoint.
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

/// The keypoints of a picture on the device, in buffers with usages `STORAGE`, `COPY_SRC` and `COPY_DST`.
#[derive(Debug)]
pub struct KeypointList {
    count: wgpu::Buffer,
    keypoints: wgpu::Buffer,
    capacity: u32,
}

impl KeypointList {
    /// Allocates a list of `capacity` keypoints.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] if the device cannot bind the list.
    pub fn new(gpu: &Gpu, capacity: u32) -> Result<Self> {
        let bytes = u64::from(capacity) * size_of::<Keypoint>() as u64;
        Ok(Self {
            count: storage_buffer(gpu, "number of keypoints", size_of::<u32>() as u64)?,
            keypoints: storage_buffer(gpu, "keypoints", bytes)?,
            capacity,
        })
    }

    /// One `u32`: the number of keypoints found, which can exceed the capacity.
    pub fn count(&self) -> &wgpu::Buffer {
        &self.count
    }

    /// The [`Keypoint`]s, in no particular order.
    pub fn keypoints(&self) -> &wgpu::Buffer {
        &self.keypoints
    }

    /// Capacity of the list, in keypoints.
    pub fn capacity(&self) -> u32 {
        self.capacity
    }
}
