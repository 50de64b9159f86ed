//! The number of workgroups of the stages after the keypoint list, from the list's own counter, so that nothing has to
//! be read back in between. `shaders/features/workgroups.wgsl`.

use crate::{
    features::keypoints::{DISPATCH_WIDTH, KeypointList},
    gpu::{Binding, Dispatch, Gpu, Kernel, Stage},
};

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "workgroups",
        source: include_str!("../../../shaders/features/workgroups.wgsl"),
        bindings: &[Binding::Read, Binding::Read, Binding::Write],
        constants: vec![("DISPATCH_WIDTH", DISPATCH_WIDTH.into())],
    }
}

/// The kernel that counts workgroups.
#[derive(Debug)]
pub struct Workgroups(Kernel);

impl Workgroups {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// A buffer of the three `u32`s of an indirect dispatch: workgroups along x, y and z.
    pub fn groups(gpu: &Gpu) -> wgpu::Buffer {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("workgroups"),
            size: size_of::<wgpu::util::DispatchIndirectArgs>() as u64,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::INDIRECT
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    /// Writes the number of workgroups to `groups`: one per keypoint of the `list`.
    pub fn prepare(&self, list: &KeypointList, groups: &wgpu::Buffer) -> Dispatch {
        self.0.dispatch(&(), &[list.count(), list.keypoints(), groups], [1, 1, 1])
    }
}
