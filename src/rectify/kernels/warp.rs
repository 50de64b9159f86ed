//! Resampling by a map. `shaders/rectify/warp.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
    rectify::{NONE, SUBPIXEL_BITS, WarpMap},
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        source_width: i32,
        source_height: i32,
        columns: u32,
        spacing_bits: u32,
    }
}

/// The resampling kernel.
#[derive(Debug)]
pub struct Warp(Kernel);

impl Warp {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "warp",
            source: include_str!("../../../shaders/rectify/warp.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("SUBPIXEL_BITS", SUBPIXEL_BITS.into()),
                ("NONE_NODE", NONE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &Self::stage()))
    }

    /// Resamples packed luma `source`, a picture of the map's source size, to packed luma `warped`, of the map's size;
    /// `nodes` has the map's node coordinates.
    pub fn prepare(
        &self,
        map: &WarpMap,
        source: &wgpu::Buffer,
        nodes: &wgpu::Buffer,
        warped: &wgpu::Buffer,
    ) -> Dispatch {
        let (Size { width, height }, source_size) = (map.size(), map.source_size());
        let params = Params {
            width,
            height,
            source_width: source_size.width as i32,
            source_height: source_size.height as i32,
            columns: map.columns(),
            spacing_bits: map.spacing_bits(),
        };
        let groups = [width.div_ceil(4).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[source, nodes, warped], groups)
    }
}
