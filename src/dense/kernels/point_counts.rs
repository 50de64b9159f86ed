//! Numbers of points of the rows of a map. `shaders/dense/point_counts.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

/// Threads per workgroup, which counts a row at a time.
const WORKGROUP: u32 = 64;

/// Number of `u32`s in front of the counts: the arguments of an indirect draw.
pub const ARGUMENTS: u32 = 4;

/// Most workgroups of a dispatch along x that every device allows.
const MOST_GROUPS: u32 = 65_535;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        least: i32,
        min_confidence: u32,
        groups: u32,
    }
}

/// Which pixels of a map are points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointRule {
    /// The smallest disparity of a point, in 1/256 px.
    pub least: i32,
    /// The least confidence of a point.
    pub min_confidence: u8,
}

/// The kernel that counts points.
#[derive(Debug)]
pub struct PointCounts(Kernel);

impl PointCounts {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "point_counts",
            source: include_str!("../../../shaders/dense/point_counts.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![("WORKGROUP", WORKGROUP.into()), ("ARGUMENTS", ARGUMENTS.into())],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Number of `u32`s of the counts of a map of `height` rows, with the arguments in front.
    pub fn words(height: u32) -> u32 {
        ARGUMENTS + height
    }

    /// Counts the points of a map of this size, behind the first [`ARGUMENTS`] words of `counts`.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        PointRule { least, min_confidence }: PointRule,
        [disparities, confidences]: [&wgpu::Buffer; 2],
        counts: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = row_groups(height);
        let params = Params { width, height, least, min_confidence: min_confidence.into(), groups };
        self.0.dispatch(&params, &[disparities, confidences, counts], [groups, 1, 1])
    }
}

/// Number of workgroups of kernels of which each handles a row at a time.
pub(super) fn row_groups(height: u32) -> u32 {
    height.min(MOST_GROUPS)
}
