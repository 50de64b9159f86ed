//! The second pass of the integral image: row sums, summed along columns. `shaders/features/integral_columns.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: u32 = 64;

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "integral_columns",
        source: include_str!("../../../shaders/features/integral_columns.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into())],
    }
}

/// The column-sum kernel.
#[derive(Debug)]
pub struct IntegralColumns(Kernel);

impl IntegralColumns {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Sums the row sums of [`super::integral_rows`] along columns, in place: `(x, y)` then holds the sum over columns
    /// below `x` and rows below `y`, modulo 2^32.
    pub fn prepare(&self, Size { width, height }: Size, sums: &wgpu::Buffer) -> Dispatch {
        self.0.dispatch(&Params { width, height }, &[sums], [(width + 1).div_ceil(WORKGROUP), 1, 1])
    }
}
