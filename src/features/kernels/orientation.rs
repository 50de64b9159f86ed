//! The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1).
//! `shaders/features/orientation.wgsl`.

use crate::{
    features::keypoints::{DISPATCH_WIDTH, KeypointList, PARAMS, Params},
    gpu::{Binding, Context, Dispatch, Kernel, Stage, uniform_buffer},
};

const WORKGROUP: u32 = 64;

/// Directions in which a window may start; a window of pi/3 is a sixth of them.
const BINS: u32 = 48;

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "orientation",
        source: include_str!("../../../shaders/features/orientation.wgsl"),
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
pub struct Orientation(Dispatch);

impl Orientation {
    /// Reads the `integral` image of a picture of `size` and writes the orientations in the `list`
    /// of its keypoints, a workgroup each; `groups` says how many (see [`super::workgroups`]).
    pub fn new(
        device: &Context<'_>,
        integral: &wgpu::Buffer,
        list: &KeypointList,
        groups: &wgpu::Buffer,
        (width, height): (u32, u32),
    ) -> Self {
        let params = uniform_buffer(device, "orientation", &Params { width, height });
        let buffers = [&params, integral, list.found(), list.keypoints()];
        Self(Kernel::new(device, &stage()).dispatch_indirect(device, &buffers, groups))
    }

    /// Records the pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.record(encoder);
    }
}
