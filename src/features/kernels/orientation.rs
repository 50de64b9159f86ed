//! The dominant direction of the gradient around each keypoint (Bay et al. 2008, section 4.1).
//! `shaders/features/orientation.wgsl`.

use crate::{
    features::keypoints::{DISPATCH_WIDTH, KeypointList, PARAMS, Params},
    gpu::{Bindable, Binding, Dispatch, Gpu, Kernel, Stage},
    image::Size,
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

/// The kernel of the orientations.
#[derive(Debug)]
pub struct Orientation(Kernel);

impl Orientation {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Reads the `integral` image of a picture and writes the orientations in the `list` of its keypoints, one workgroup
    /// per keypoint; `groups` says how many (see [`super::workgroups`]).
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        integral: &wgpu::Buffer,
        list: &KeypointList,
        groups: &wgpu::Buffer,
    ) -> Dispatch {
        let bound: [&dyn Bindable; 3] = [integral, list.found(), list.keypoints()];
        self.0.dispatch_indirect(&Params { width, height }, &bound, groups)
    }
}
