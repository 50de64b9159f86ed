//! The weighted median of a map. `shaders/dense/weighted_median.wgsl`.

use super::rows_per_thread::rows_per_thread;
use crate::{
    dense::config::Median,
    disparity::NONE,
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 4];

/// A sentinel above any disparity.
const FARTHEST: i64 = 1 << 30;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
        luma_start: u32,
    }
}

/// The weighted-median kernel.
#[derive(Debug)]
pub struct WeightedMedian {
    kernel: Kernel,
    rows: u32,
}

impl WeightedMedian {
    /// Source, bindings and constants of the kernel, with `rows` rows per thread.
    pub fn stage(median: Median, rows: u32) -> Stage {
        let side = 2 * median.radius + 1;
        Stage {
            name: "weighted_median",
            source: include_str!("../../../shaders/dense/weighted_median.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("RADIUS", median.radius.into()),
                ("SIDE", side.into()),
                ("KEPT", (side - 1).into()),
                ("SPAN", (side + 3).into()),
                ("HALVING_BITS", median.halving_bits.into()),
                ("ROWS", rows.into()),
                ("FARTHEST", FARTHEST),
                ("NONE", NONE.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, median: Median) -> Self {
        let rows = rows_per_thread(gpu);
        Self { kernel: Kernel::new(gpu, &Self::stage(median, rows)), rows }
    }

    /// Filters `disparities` into `filtered`, weighted by packed `luma` of their view; `first_row` is the row of the
    /// luma of their first row.
    pub fn prepare(
        &self,
        Size { width, height }: Size,
        (luma, first_row): (&wgpu::Buffer, u32),
        disparities: &wgpu::Buffer,
        filtered: &wgpu::Buffer,
    ) -> Dispatch {
        let params = Params { width, height, luma_start: first_row * width.div_ceil(4) };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), height.div_ceil(self.rows * WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[luma, disparities, filtered], groups)
    }
}
