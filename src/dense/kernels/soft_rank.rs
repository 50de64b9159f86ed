//! Soft ranks, laid out for block matching. `shaders/dense/soft_rank.wgsl`.

use super::{pad::PadParams, rows_per_thread::rows_per_thread};
use crate::gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage};

const WORKGROUP: [u32; 2] = [32, 2];

/// The largest difference of a neighbour that counts, in grey levels: above the noise of cameras, below most edges.
pub const SOFT_RANK_LIMIT: i32 = 3;

/// The soft rank of a pixel as bright as its neighbours.
pub const SOFT_RANK_MIDDLE: i32 = 128;

/// The kernel of the soft ranks.
#[derive(Debug)]
pub struct SoftRank {
    kernel: Kernel,
    rows: u32,
}

impl SoftRank {
    /// Source, bindings and constants of the kernel, with `rows` rows per thread.
    pub fn stage(rows: u32) -> Stage {
        Stage {
            name: "soft_rank",
            source: include_str!("../../../shaders/dense/soft_rank.wgsl"),
            bindings: &[Binding::Uniform(PadParams::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("ROWS", rows.into()),
                ("LIMIT", SOFT_RANK_LIMIT.into()),
                ("MIDDLE", SOFT_RANK_MIDDLE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        let rows = rows_per_thread(gpu);
        Self { kernel: Kernel::new(gpu, &Self::stage(rows)), rows }
    }

    /// Computes the soft ranks of packed `luma` and pads them into `padded`, as `params` say.
    pub fn prepare(&self, params: PadParams, luma: &wgpu::Buffer, padded: &wgpu::Buffer) -> Dispatch {
        // The rows of the plane that lie in the picture.
        let first = params.first_row.max(0) as u32;
        let end = params.height.min(params.rows.saturating_add_signed(params.first_row));
        let threads = end.saturating_sub(first).div_ceil(2 * self.rows) * 2;
        let groups = [params.stride.div_ceil(WORKGROUP[0]), threads.div_ceil(WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[luma, padded], groups)
    }
}
