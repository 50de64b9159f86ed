//! The wide census transform, with a mark of weak texture. `shaders/dense/wide_census.wgsl`.

use super::{census::Census, rows_per_thread::rows_per_thread};
use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        stride: u32,
        offset: u32,
    }
}

/// The wide-census kernel.
#[derive(Debug)]
pub struct WideCensus {
    kernel: Kernel,
    rows: u32,
}

impl WideCensus {
    /// Source, bindings and constants of the kernel, with `rows` rows per thread. Sums of 3x3 lumas differ by at most
    /// `spread` where texture is weak.
    pub fn stage(spread: u32, rows: u32) -> Stage {
        Stage {
            name: "wide_census",
            source: include_str!("../../../shaders/dense/wide_census.wgsl"),
            bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
            constants: vec![
                ("WORKGROUP_WIDTH", WORKGROUP[0].into()),
                ("WORKGROUP_HEIGHT", WORKGROUP[1].into()),
                ("ROWS", rows.into()),
                ("SPREAD", spread.into()),
            ],
        }
    }

    /// Compiles the kernel.
    pub fn new(gpu: &Gpu, spread: u32) -> Self {
        let rows = rows_per_thread(gpu);
        Self { kernel: Kernel::new(gpu, &Self::stage(spread, rows)), rows }
    }

    /// Transforms the rows in `padded`, laid out as [`Census::padding`] says, to one `u32` per pixel from word `offset`
    /// of `census` on.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        padded: &wgpu::Buffer,
        census: &wgpu::Buffer,
        offset: u32,
    ) -> Dispatch {
        let params = Params { width, rows, stride: Census::stride(width), offset };
        let groups = [width.div_ceil(4 * WORKGROUP[0]), rows.div_ceil(self.rows * WORKGROUP[1]), 1];
        self.kernel.dispatch(&params, &[padded, census], groups)
    }
}
