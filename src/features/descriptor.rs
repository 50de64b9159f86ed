//! The 64 values that describe each keypoint's surroundings (Agrawal et al., ECCV 2008, section
//! 3.3: M-SURF).

use super::{
    DESCRIPTOR_LENGTH,
    keypoints::{DISPATCH_WIDTH, PARAMS, Params},
};
use crate::{
    error::Result,
    gpu::{Binding, Kernel, Stage, storage_buffer, uniform_buffer},
};

const CONSTANTS: [(&str, i64); 1] = [("DISPATCH_WIDTH", DISPATCH_WIDTH as i64)];

/// The stage for keypoints with an orientation.
pub fn turned_stage() -> Stage {
    Stage {
        name: "descriptor_turned",
        source: concat!(
            include_str!("../../shaders/haar.wgsl"),
            include_str!("../../shaders/descriptor.wgsl"),
            include_str!("../../shaders/descriptor_turned.wgsl")
        ),
        bindings: &[PARAMS, Binding::Read, Binding::Read, Binding::Read, Binding::Write],
        constants: CONSTANTS.into(),
    }
}

/// The stage for keypoints whose orientation is 0.
pub fn upright_stage() -> Stage {
    Stage {
        name: "descriptor_upright",
        source: concat!(
            include_str!("../../shaders/haar.wgsl"),
            include_str!("../../shaders/descriptor.wgsl"),
            include_str!("../../shaders/descriptor_upright.wgsl")
        ),
        bindings: &[PARAMS, Binding::Read, Binding::Read, Binding::Write],
        constants: CONSTANTS.into(),
    }
}

/// The descriptors of one keypoint list.
pub struct Descriptor {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    descriptors: wgpu::Buffer,
}

impl Descriptor {
    /// Reads the `integral` image of a picture, the `list` of its keypoints (with room for
    /// `capacity`) and, unless all are 0, their `orientations`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind so many descriptors.
    pub fn new(
        device: &wgpu::Device,
        integral: &wgpu::Buffer,
        list: &wgpu::Buffer,
        orientations: Option<&wgpu::Buffer>,
        size: (u32, u32),
        capacity: u32,
    ) -> Result<Self> {
        let params = uniform_buffer(device, "picture size", &Params { width: size.0, height: size.1 });
        let bytes = u64::from(capacity) * size_of::<[f32; DESCRIPTOR_LENGTH]>() as u64;
        let descriptors = storage_buffer(device, "descriptors", bytes)?;
        let (kernel, bind_group) = if let Some(orientations) = orientations {
            let kernel = Kernel::new(device, &turned_stage());
            let bind_group = kernel.bind(device, &[&params, integral, list, orientations, &descriptors]);
            (kernel, bind_group)
        } else {
            let kernel = Kernel::new(device, &upright_stage());
            let bind_group = kernel.bind(device, &[&params, integral, list, &descriptors]);
            (kernel, bind_group)
        };
        Ok(Self { kernel, bind_group, descriptors })
    }

    /// Records a workgroup for each keypoint; `groups` says how many (see [`super::dispatch`]).
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, groups: &wgpu::Buffer) {
        self.kernel.record_indirect(encoder, &self.bind_group, groups);
    }

    /// [`DESCRIPTOR_LENGTH`] values a keypoint, in the list's order.
    pub fn descriptors(&self) -> &wgpu::Buffer {
        &self.descriptors
    }
}
