//! Packed luma to RGBA8. `shaders/luma/rgba.wgsl`.

use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [64, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_row: u32,
    }
}

/// The stage that converts packed luma to RGBA8.
pub fn stage() -> Stage {
    Stage {
        name: "rgba",
        source: include_str!("../../../shaders/luma/rgba.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// The kernel from packed luma to RGBA8.
#[derive(Debug)]
pub struct LumaToRgba(Kernel);

impl LumaToRgba {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Converts the rows of packed `luma` from `first_row` on to `pixels`, one `u32` per pixel with red in its lowest
    /// byte.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        first_row: u32,
        luma: &wgpu::Buffer,
        pixels: &wgpu::Buffer,
    ) -> Dispatch {
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&Params { width, rows, first_row }, &[luma, pixels], groups)
    }
}
