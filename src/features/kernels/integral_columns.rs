//! The second half of the integral image: the row sums, summed along columns.
//! `shaders/features/integral_columns.wgsl`.

use crate::gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, uniform_buffer};

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

/// The integral image of pictures of one size.
pub struct IntegralColumns(Dispatch);

impl IntegralColumns {
    /// Works in place, on the `sums` of [`super::integral_rows`]: what comes out has, at `(x, y)`,
    /// the sum over all columns below `x` of the rows below `y`, modulo 2^32.
    pub fn new(device: &Context<'_>, sums: &wgpu::Buffer, width: u32, height: u32) -> Self {
        let params = uniform_buffer(device, "integral_columns", &Params { width, height });
        let groups = [(width + 1).div_ceil(WORKGROUP), 1, 1];
        Self(Kernel::new(device, &stage()).dispatch(device, &[&params, sums], groups))
    }

    /// Records the pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.0.record(encoder);
    }
}
