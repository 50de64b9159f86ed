//! The number of workgroups for the stages after the keypoint list, from the list's own counter,
//! so that nothing has to be read back in between. `shaders/features/workgroups.wgsl`.

use crate::{
    features::keypoints::{DISPATCH_WIDTH, KeypointList},
    gpu::{Binding, Context, Dispatch, Kernel, Stage},
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

/// The workgroups for one keypoint list.
pub struct Workgroups {
    dispatch: Dispatch,
    groups: wgpu::Buffer,
}

impl Workgroups {
    /// Reads the counter of `list`.
    pub fn new(device: &Context<'_>, list: &KeypointList) -> Self {
        let groups = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("workgroups"),
            size: size_of::<wgpu::util::DispatchIndirectArgs>() as u64,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::INDIRECT
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let buffers = [list.found(), list.keypoints(), &groups];
        let dispatch = Kernel::new(device, &stage()).dispatch(device, &buffers, [1, 1, 1]);
        Self { dispatch, groups }
    }

    /// Records the count.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.dispatch.record(encoder);
    }

    /// Three words: workgroups along x, y and z.
    pub fn groups(&self) -> &wgpu::Buffer {
        &self.groups
    }
}
