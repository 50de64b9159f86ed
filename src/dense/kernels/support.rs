//! Support: the removal of disparities that too few neighbours share. `shaders/dense/support.wgsl`.

use super::{
    map_buffer::{MapBuffer, MapLayout},
    rows_per_thread::rows_per_thread,
};
use crate::{
    dense::config::FILLED,
    disparity::{NONE, SCALE},
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
};

const WORKGROUP: [u32; 2] = [16, 4];

/// Radius of the window, (side - 1) / 2, in pixels.
pub const SUPPORT_RADIUS: u32 = 3;

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
    rows: u32,
}

impl Support {
    /// Source, bindings and constants of the kernel, where `least` pixels of the window must agree, and with
    /// `majority` half of the window must not be nearer, with `rows` rows per thread.
    pub fn stage(least: u32, majority: bool, rows: u32) -> Stage {
        let side = 2 * SUPPORT_RADIUS + 1;
        Stage {
            name: "support",
            source: include_str!("../../../shaders/dense/support.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("RADIUS", SUPPORT_RADIUS.into()),
                ("SIDE", side.into()),
                ("SPAN", (side + 3).into()),
                ("KEPT", (side - 1).into()),
                ("ROWS", rows.into()),
                ("TOLERANCE", SUPPORT_TOLERANCE.into()),
                ("LEAST", least.into()),
                ("MAJORITY", majority.into()),
                ("MEASURED", i64::from(FILLED) + 1),
                ("NONE", NONE.into()),
                ("FAR", FAR),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, least: u32, majority: bool) -> Self {
        let rows = rows_per_thread(gpu);
        Self { kernel: Kernel::new(gpu, &Self::stage(least, majority, rows)), rows }
    }

    /// Copies `matches` to `supported`, a map of the same layout, and drops disparities that too few neighbours share.
    /// `residuals` come from [`super::Residual`].
    pub fn prepare(&self, matches: MapBuffer<'_>, residuals: &wgpu::Buffer, supported: &wgpu::Buffer) -> Dispatch {
        let MapLayout { width, rows: height } = matches.layout;
        let params = Params { width, height, confidence_offset: matches.layout.confidence_offset() };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), height.div_ceil(self.rows * WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[matches.buffer, residuals, supported], groups)
    }
}
