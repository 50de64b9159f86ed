//! The map of a warped picture as one of another picture. `shaders/dense/map_back.wgsl`.

use super::map_buffer::MapBuffer;
use crate::{
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
    rectify::{NONE as NONE_NODE, SUBPIXEL_BITS, WarpMap},
};

const WORKGROUP: [u32; 2] = [16, 8];

/// Largest difference of neighbouring disparities of one surface, in 1/256 px.
pub const SURFACE: i32 = SCALE;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        source_width: i32,
        source_height: i32,
        columns: u32,
        spacing_bits: u32,
        confidence_offset: u32,
    }
}

/// The kernel that takes a map back.
#[derive(Debug)]
pub struct MapBack(Kernel);

impl MapBack {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "map_back",
            source: include_str!("../../../shaders/dense/map_back.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SUBPIXEL_BITS", SUBPIXEL_BITS.into()),
                ("NONE_NODE", NONE_NODE.into()),
                ("NONE", NONE.into()),
                ("SURFACE", SURFACE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Takes disparities and packed confidences of a picture of the source size of `back` to a map of its size; `nodes` has the node
    /// coordinates of `back`.
    pub fn prepare(
        &self,
        back: &WarpMap,
        nodes: &wgpu::Buffer,
        [disparities, confidences]: [&wgpu::Buffer; 2],
        map: MapBuffer<'_>,
    ) -> Dispatch {
        let (Size { width, height }, source_size) = (back.size(), back.source_size());
        let params = Params {
            width,
            height,
            source_width: source_size.width as i32,
            source_height: source_size.height as i32,
            columns: back.columns(),
            spacing_bits: back.spacing_bits(),
            confidence_offset: map.layout.confidence_offset(),
        };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[disparities, confidences, nodes, map.buffer], groups)
    }
}
