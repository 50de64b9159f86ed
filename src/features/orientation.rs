//! The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1).

use super::keypoints::{DISPATCH_WIDTH, PARAMS, Params};
use crate::{
    error::Result,
    gpu::{Binding, Kernel, Stage, storage_buffer, uniform_buffer},
};

const WORKGROUP: u32 = 64;

/// Directions are gathered in this many bins; the sliding window of pi/3 is a sixth of them.
const BINS: u32 = 42;

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "orientation",
        source: concat!(include_str!("../../shaders/haar.wgsl"), include_str!("../../shaders/orientation.wgsl")),
        bindings: &[PARAMS, Binding::Read, Binding::Read, Binding::Write],
        constants: vec![
            ("WORKGROUP", WORKGROUP.into()),
            ("DISPATCH_WIDTH", DISPATCH_WIDTH.into()),
            ("BINS", BINS.into()),
            ("WINDOW", (BINS / 6).into()),
        ],
    }
}

/// The orientations of one keypoint list.
pub struct Orientation {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    orientations: wgpu::Buffer,
}

impl Orientation {
    /// Reads the `integral` image of a picture and the `list` of its keypoints (with room for
    /// `capacity`).
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind so many orientations.
    pub fn new(
        device: &wgpu::Device,
        integral: &wgpu::Buffer,
        list: &wgpu::Buffer,
        size: (u32, u32),
        capacity: u32,
    ) -> Result<Self> {
        let kernel = Kernel::new(device, &stage());
        let params = uniform_buffer(device, "picture size", &Params { width: size.0, height: size.1 });
        let orientations = storage_buffer(device, "orientations", 4 * u64::from(capacity))?;
        let bind_group = kernel.bind(device, &[&params, integral, list, &orientations]);
        Ok(Self { kernel, bind_group, orientations })
    }

    /// Records a workgroup for each keypoint; `groups` says how many (see [`super::dispatch`]).
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, groups: &wgpu::Buffer) {
        self.kernel.record_indirect(encoder, &self.bind_group, groups);
    }

    /// Radians as `f32`, 0 to 2 pi, in the list's order.
    pub fn orientations(&self) -> &wgpu::Buffer {
        &self.orientations
    }
}
