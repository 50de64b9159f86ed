//! The 64 values that describe each keypoint's surroundings (Bay et al. 2008, section 4.2).
//! `shaders/features/descriptor.wgsl`.

use crate::{
    error::Result,
    features::{
        DESCRIPTOR_LENGTH,
        keypoints::{DISPATCH_WIDTH, KeypointList, PARAMS, Params},
    },
    gpu::{Binding, Context, Dispatch, Kernel, Stage, storage_buffer, uniform_buffer},
};

/// The stage, for axes of the picture (`upright`) or along each keypoint's orientation.
pub fn stage(upright: bool) -> Stage {
    Stage {
        name: "descriptor",
        source: include_str!("../../../shaders/features/descriptor.wgsl"),
        bindings: &[PARAMS, Binding::Read, Binding::Read, Binding::Read, Binding::Write],
        constants: vec![("DISPATCH_WIDTH", DISPATCH_WIDTH.into()), ("UPRIGHT", upright.into())],
    }
}

/// The descriptors of one keypoint list.
pub struct Descriptor {
    dispatch: Dispatch,
    descriptors: wgpu::Buffer,
}

impl Descriptor {
    /// Reads the `integral` image of a picture of `size` and the `list` of its keypoints, a
    /// workgroup each; `groups` says how many (see [`super::workgroups`]).
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind so many descriptors.
    pub fn new(
        device: &Context<'_>,
        integral: &wgpu::Buffer,
        list: &KeypointList,
        groups: &wgpu::Buffer,
        (width, height): (u32, u32),
        upright: bool,
    ) -> Result<Self> {
        let params = uniform_buffer(device, "descriptor", &Params { width, height });
        let bytes = u64::from(list.capacity()) * size_of::<[f32; DESCRIPTOR_LENGTH]>() as u64;
        let descriptors = storage_buffer(device, "descriptors", bytes)?;
        let buffers = [&params, integral, list.found(), list.keypoints(), &descriptors];
        let dispatch = Kernel::new(device, &stage(upright)).dispatch_indirect(device, &buffers, groups);
        Ok(Self { dispatch, descriptors })
    }

    /// Records the pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.dispatch.record(encoder);
    }

    /// [`DESCRIPTOR_LENGTH`] values a keypoint, in the list's order.
    pub fn descriptors(&self) -> &wgpu::Buffer {
        &self.descriptors
    }
}
