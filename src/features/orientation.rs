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

/// A buffer for the orientations of `capacity` keypoints: radians as `f32`, in the list's order,
/// all 0 at first.
///
/// # Errors
/// [`crate::Error::TooLarge`] where the device could not bind it.
pub fn orientation_buffer(device: &wgpu::Device, capacity: u32) -> Result<wgpu::Buffer> {
    storage_buffer(device, "orientations", 4 * u64::from(capacity))
}

/// The orientations of one keypoint list.
pub struct Orientation {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
}

impl Orientation {
    /// Reads the `integral` image of a picture and the `list` of its keypoints, and writes
    /// `orientations` (see [`orientation_buffer`]).
    pub fn new(
        device: &wgpu::Device,
        integral: &wgpu::Buffer,
        list: &wgpu::Buffer,
        orientations: &wgpu::Buffer,
        width: u32,
        height: u32,
    ) -> Self {
        let kernel = Kernel::new(device, &stage());
        let params = uniform_buffer(device, "picture size", &Params { width, height });
        let bind_group = kernel.bind(device, &[&params, integral, list, orientations]);
        Self { kernel, bind_group }
    }

    /// Records a workgroup for each keypoint; `groups` says how many (see [`super::dispatch`]).
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, groups: &wgpu::Buffer) {
        self.kernel.record_indirect(encoder, &self.bind_group, groups);
    }
}
