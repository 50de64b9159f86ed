//! The descriptor: 64 values per keypoint (Bay et al. 2008, section 4.2). `shaders/features/descriptor.wgsl`.

use crate::{
    features::{
        DESCRIPTOR_LENGTH,
        keypoints::{DISPATCH_WIDTH, KeypointList, PARAMS, Params},
    },
    gpu::{Bindable, Binding, Dispatch, Gpu, Kernel, Stage},
    image::Size,
};

/// The stage, with axes along the picture (`upright`) or along each keypoint's orientation.
pub fn stage(upright: bool) -> Stage {
    Stage {
        name: "descriptor",
        source: include_str!("../../../shaders/features/descriptor.wgsl"),
        bindings: &[PARAMS, Binding::Read, Binding::Read, Binding::Read, Binding::Write],
        constants: vec![("DISPATCH_WIDTH", DISPATCH_WIDTH.into()), ("UPRIGHT", upright.into())],
    }
}

/// The descriptor kernel.
#[derive(Debug)]
pub struct Descriptor(Kernel);

impl Descriptor {
    /// Compiles the kernel, with axes along the picture (`upright`) or along each keypoint's orientation.
    pub fn new(gpu: &Gpu, upright: bool) -> Self {
        Self(Kernel::new(gpu, &stage(upright)))
    }

    /// Bytes of the descriptors of a full list: [`DESCRIPTOR_LENGTH`] values per keypoint.
    pub fn bytes(list: &KeypointList) -> u64 {
        u64::from(list.capacity()) * size_of::<[f32; DESCRIPTOR_LENGTH]>() as u64
    }

    /// Describes the keypoints of `list` from the `integral` image of their picture, one workgroup per keypoint,
    /// dispatched indirectly by `groups` (see [`super::workgroups`]). The `descriptors` are in the order of the list.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        integral: &wgpu::Buffer,
        list: &KeypointList,
        groups: &wgpu::Buffer,
        descriptors: &wgpu::Buffer,
    ) -> Dispatch {
        let bound: [&dyn Bindable; 4] = [integral, list.count(), list.keypoints(), descriptors];
        self.0.dispatch_indirect(&Params { width, height }, &bound, groups)
    }
}
