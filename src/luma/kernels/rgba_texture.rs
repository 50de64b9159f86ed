//! Conversion of a texture to RGBA8 in a buffer. `shaders/luma/rgba_texture.wgsl`.

use super::luma_texture::TexelFormat;
use crate::{
    gpu::{Binding, Dispatch, Gpu, Kernel, ShaderType, Stage, shader_struct},
    image::Size,
};

const WORKGROUP: [u32; 2] = [64, 4];

shader_struct! {
    struct Params {
        width: u32,
        rows: u32,
        first_column: u32,
        first_row: u32,
        grey: u32,
        linear: u32,
    }
}

/// The stage.
pub fn stage() -> Stage {
    Stage {
        name: "rgba_texture",
        source: include_str!("../../../shaders/luma/rgba_texture.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Picture, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// The kernel that converts a texture to RGBA8 in a buffer.
#[derive(Debug)]
pub struct RgbaTexture(Kernel);

impl RgbaTexture {
    /// Compiles the kernel.
    pub fn new(gpu: &Gpu) -> Self {
        Self(Kernel::new(gpu, &stage()))
    }

    /// Converts the texels of `picture`, a view of this format, from column and row `first` on to `pixels`, one `u32` per pixel
    /// with red in its lowest byte.
    pub fn prepare(
        &self,
        Size { width, height: rows }: Size,
        format: TexelFormat,
        (picture, [first_column, first_row]): (&wgpu::TextureView, [u32; 2]),
        pixels: &wgpu::Buffer,
    ) -> Dispatch {
        let params =
            Params { width, rows, first_column, first_row, grey: format.grey.into(), linear: format.srgb.into() };
        let groups = [width.div_ceil(WORKGROUP[0]), rows.div_ceil(WORKGROUP[1]), 1];
        self.0.dispatch(&params, &[picture, pixels], groups)
    }
}
