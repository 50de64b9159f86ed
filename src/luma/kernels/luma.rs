//! RGBA8 to packed luma. `shaders/luma/luma.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The stage that converts RGBA8 to packed luma.
pub fn stage() -> Stage {
    Stage {
        name: "luma",
        source: include_str!("../../../shaders/luma/luma.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// The kernel from RGBA8 to packed luma: `(77 R + 150 G + 29 B + 128) >> 8`.
#[derive(Debug)]
pub struct RgbaToLuma(Kernel);

impl RgbaToLuma {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Converts `pixels`, one `u32` per pixel with red in its lowest byte, to packed `luma`.
    pub fn prepare(&self, Size { width, height }: Size, pixels: &wgpu::Buffer, luma: &wgpu::Buffer) -> Dispatch {
        let groups = [width.div_ceil(4).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&Params { width, height }, &[pixels, luma], groups)
    }
}
