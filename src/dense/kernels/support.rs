//! Support: the removal of disparities that too few neighbours share. `shaders/dense/support.wgsl` and
//! `tile_support.wgsl`.

use super::{
    map_buffer::{MapBuffer, MapLayout},
    windows::Text,
};
use crate::{
    dense::config::FILLED,
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, Windows, shader_struct},
};

/// Radius of the window, (side - 1) / 2, in pixels.
pub const SUPPORT_RADIUS: u32 = 3;
const SIDE: u32 = 2 * SUPPORT_RADIUS + 1;

/// Largest difference of disparities that support each other, in 1/256 px.
pub const SUPPORT_TOLERANCE: i32 = SCALE;

/// A sentinel that differs from every disparity by more than twice the tolerance.
const FAR: i64 = 1 << 30;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        confidence_offset: u32,
    }
}

/// The kernel that removes speckles.
#[derive(Debug)]
pub struct Support {
    kernel: Kernel,
    /// Pixels per workgroup along x and y.
    tile: [u32; 2],
}

impl Support {
    /// Source, bindings and constants of the kernel, where `least` pixels of the window must agree, and with
    /// `majority` half of the window must not be nearer.
    pub fn stage(least: u32, majority: bool, windows: Windows) -> Stage {
        Self::text(windows).stage(
            &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            vec![
                ("RADIUS", SUPPORT_RADIUS.into()),
                ("SIDE", SIDE.into()),
                ("TOLERANCE", SUPPORT_TOLERANCE.into()),
                ("LEAST", least.into()),
                ("MAJORITY", majority.into()),
                ("MEASURED", i64::from(FILLED) + 1),
                ("NONE", NONE.into()),
                ("FAR", FAR),
            ],
        )
    }

    fn text(windows: Windows) -> Text {
        match windows {
            Windows::Rows => Text::rows(
                "support",
                include_str!("../../../shaders/dense/support.wgsl"),
                vec![("SPAN", (SIDE + 3).into()), ("KEPT", (SIDE - 1).into())],
            ),
            Windows::Tiles => Text {
                name: "tile_support",
                source: include_str!("../../../shaders/dense/tile_support.wgsl"),
                workgroup: [8, 8],
                pixels: [4, 1],
                constants: Vec::new(),
            },
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, least: u32, majority: bool, windows: Windows) -> Self {
        let kernel = Kernel::new(gpu, &Self::stage(least, majority, windows));
        Self { kernel, tile: Self::text(windows).tile() }
    }

    /// Copies `matches` to `supported`, a map of the same layout, and drops disparities that too few neighbours share.
    /// `residuals` come from [`super::Residual`].
    pub fn prepare(&self, matches: MapBuffer<'_>, residuals: &wgpu::Buffer, supported: &wgpu::Buffer) -> Dispatch {
        let MapLayout { width, rows: height } = matches.layout;
        let params = Params { width, height, confidence_offset: matches.layout.confidence_offset() };
        let groups = [width.div_ceil(self.tile[0]), height.div_ceil(self.tile[1]), 1];
        self.kernel.dispatch(&params, &[matches.buffer, residuals, supported], groups)
    }
}
