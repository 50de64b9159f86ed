//! The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1).
//! `shaders/features/orientation.wgsl`.

use crate::{
    features::keypoints::{DISPATCH_WIDTH, KeypointList, PARAMS, Params},
    gpu::{Bindable, Binding, Dispatch, Gpu, Kernel, Stage},
    image::Size,
};

const WORKGROUP: u32 = 64;

/// Possible first directions of a window; a window of pi/3 spans a sixth of them.
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

/// The orientation kernel.
#[derive(Debug)]
pub struct Orientation(Kernel);

impl Orientation {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Writes the orientations of the keypoints of `list` from the `integral` image of their picture, one workgroup per
    /// keypoint, dispatched indirectly by `groups` (see [`super::workgroups`]).
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        integral: &wgpu::Buffer,
        list: &KeypointList,
        groups: &wgpu::Buffer,
    ) -> Dispatch {
        let bound: [&dyn Bindable; 3] = [integral, list.count(), list.keypoints()];
        self.0.dispatch_indirect(&Params { width, height }, &bound, groups)
    }
}
