//! The points of a map as vertices. `shaders/dense/points.wgsl`.

use super::point_counts::{ARGUMENTS, PointRule, row_groups};
use crate::{
    dense::reprojection::DepthTable,
    gpu::{Binding, Dispatch, Gpu, Kernel, ROW_BITS, ShaderType, Stage, WordTexture, shader_struct},
    image::Size,
    luma::TexelFormat,
};

/// Threads per workgroup, which writes a row at a time.
const WORKGROUP: u32 = 64;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        least: i32,
        min_confidence: u32,
        groups: u32,
        first: i32,
        last: i32,
        cx: f32,
        cy: f32,
        capacity: u32,
        instanced: u32,
        grey: u32,
        linear: u32,
    }
}

/// What the points of a map are made of.
#[derive(Clone, Copy, Debug)]
pub struct PointSources<'a> {
    /// Width and height of the map, in pixels.
    pub size: Size,
    /// One `i32` per pixel: the disparity, in 1/256 px.
    pub disparities: &'a wgpu::Buffer,
    /// Packed confidences.
    pub confidences: &'a wgpu::Buffer,
    /// The reference view, for colours, and its format.
    pub picture: (&'a wgpu::TextureView, TexelFormat),
}

/// How the vertices of points are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLayout {
    /// The principal point, in pixels.
    pub centre: [f32; 2],
    /// Most points that are written.
    pub capacity: u32,
    /// 0: a point is a vertex; otherwise it is an instance of so many vertices.
    pub instanced: u32,
}

/// The kernel that writes points.
#[derive(Debug)]
pub struct Points(Kernel);

impl Points {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "points",
            source: include_str!("../../../shaders/dense/points.wgsl"),
            bindings: &[
                Binding::Uniform(Params::SHAPE),
                Binding::Read,
                Binding::Read,
                Binding::Words,
                Binding::Picture,
                Binding::Write,
                Binding::Write,
            ],
            constants: vec![
                ("WORKGROUP", WORKGROUP.into()),
                ("ARGUMENTS", ARGUMENTS.into()),
                ("ROW_BITS", ROW_BITS.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Writes the points of a map whose rows were counted to `counts`, and the arguments of their draw in front of the counts.
    pub fn prepare(
        &self,
        PointSources { size: Size { width, height }, disparities, confidences, picture: (picture, format) }: PointSources<'_>,
        PointRule { least, min_confidence }: PointRule,
        (table, words): (&DepthTable, &WordTexture),
        PointLayout { centre: [cx, cy], capacity, instanced }: PointLayout,
        [counts, vertices]: [&wgpu::Buffer; 2],
    ) -> Dispatch {
        let groups = row_groups(height);
        let params = Params {
            width,
            height,
            least,
            min_confidence: min_confidence.into(),
            groups,
            first: table.first(),
            last: table.last(),
            cx,
            cy,
            capacity,
            instanced,
            grey: format.grey.into(),
            linear: format.srgb.into(),
        };
        let bound: [&dyn crate::gpu::Bindable; 6] = [disparities, confidences, &words.view, picture, counts, vertices];
        self.0.dispatch(&params, &bound, [groups, 1, 1])
    }
}
