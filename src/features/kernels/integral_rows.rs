//! The first pass of the integral image, which gives box sums of grey values in four reads (Viola and Jones, CVPR
//! 2001): sums along rows. `shaders/features/integral_rows.wgsl`.

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
        name: "integral_rows",
        source: include_str!("../../../shaders/features/integral_rows.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into())],
    }
}

/// The row-sum kernel.
#[derive(Debug)]
pub struct IntegralRows(Kernel);

impl IntegralRows {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Bytes of an integral image: `height + 1` rows of `width + 1` `u32`s.
    pub fn bytes(Size { width, height }: Size) -> u64 {
        4 * (u64::from(width) + 1) * (u64::from(height) + 1)
    }

    /// Sums packed `luma` of a picture along rows into `sums`, whose row 0 and column 0 are 0.
    pub fn prepare(&self, Size { width, height }: Size, luma: &wgpu::Buffer, sums: &wgpu::Buffer) -> Dispatch {
        self.0.dispatch(&Params { width, height }, &[luma, sums], [(height + 1).div_ceil(WORKGROUP), 1, 1])
    }
}
