//! Resampling of a picture in colour by a map. `shaders/rectify/warp_colours.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    rectify::{NONE, SUBPIXEL_BITS, WarpMap},
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
        source_width: i32,
        source_height: i32,
        columns: u32,
        spacing_bits: u32,
    }
}

/// The kernel that resamples a picture in colour.
#[derive(Debug)]
pub struct WarpColours(Kernel);

impl WarpColours {
    /// Source, bindings and constants of the kernel.
    pub fn stage() -> Stage {
        Stage {
            name: "warp_colours",
            source: include_str!("../../../shaders/rectify/warp_colours.wgsl"),
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

    /// Resamples RGBA8 `source`, a picture of the map's source size, to `rows` rows of the map's picture from row `first_row` on,
    /// in `warped`; `nodes` has the map's node coordinates.
    pub fn prepare(
        &self,
        map: &WarpMap,
        [first_row, rows]: [u32; 2],
        source: &wgpu::Buffer,
        nodes: &wgpu::Buffer,
        warped: &wgpu::Buffer,
    ) -> Dispatch {
        let (width, source_size) = (map.size().width, map.source_size());
        let params = Params {
            width,
            rows,
            first_row,
            source_width: source_size.width as i32,
            source_height: source_size.height as i32,
            columns: map.columns(),
            spacing_bits: map.spacing_bits(),
        };
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[source, nodes, warped], groups)
    }
}
