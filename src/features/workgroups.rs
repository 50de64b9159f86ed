//! The number of workgroups for the stages after the keypoint list, from the list's own counter,
//! so that nothing has to be read back in between.

use super::keypoints::DISPATCH_WIDTH;
use crate::gpu::{Binding, Kernel, Stage};

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "dispatch",
        source: include_str!("../../shaders/dispatch.wgsl"),
        bindings: &[Binding::Read, Binding::Write],
        constants: vec![("DISPATCH_WIDTH", DISPATCH_WIDTH.into())],
    }
}

/// The workgroups for one keypoint list.
pub struct Dispatch {
    kernel: Kernel,
    bind_group: wgpu::BindGroup,
    groups: wgpu::Buffer,
}

impl Dispatch {
    /// Reads the counter of `list`.
    pub fn new(device: &wgpu::Device, list: &wgpu::Buffer) -> Self {
        let kernel = Kernel::new(device, &stage());
        let groups = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("workgroups"),
            size: size_of::<wgpu::util::DispatchIndirectArgs>() as u64,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::INDIRECT
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bind_group = kernel.bind(device, &[list, &groups]);
        Self { kernel, bind_group, groups }
    }

    /// Records the count.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.kernel.record(encoder, &self.bind_group, [1, 1, 1]);
    }

    /// Three words: workgroups along x, y and z.
    pub fn groups(&self) -> &wgpu::Buffer {
        &self.groups
    }
}
