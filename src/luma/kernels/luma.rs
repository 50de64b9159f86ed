//! RGBA8 to packed luma. `shaders/luma/luma.wgsl`.

use crate::{
    error::Result,
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, storage_buffer, uniform_buffer},
    luma::packed_bytes,
};

const WORKGROUP: [u32; 2] = [16, 8];

shader_struct! {
    struct Params {
        width: u32,
        height: u32,
    }
}

/// The stage that turns RGBA8 into packed luma.
pub fn stage() -> Stage {
    Stage {
        name: "luma",
        source: include_str!("../../../shaders/luma/luma.wgsl"),
        bindings: &[Binding::Uniform(Params::SHAPE), Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP_WIDTH", WORKGROUP[0].into()), ("WORKGROUP_HEIGHT", WORKGROUP[1].into())],
    }
}

/// RGBA8 to packed luma for pictures of one size: `(77 R + 150 G + 29 B + 128) >> 8`.
pub struct RgbaToLuma {
    dispatch: Dispatch,
    luma: wgpu::Buffer,
}

impl RgbaToLuma {
    /// Reads `pixels`: a word a pixel, red in its lowest byte.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind the picture.
    pub fn new(device: &Context<'_>, pixels: &wgpu::Buffer, width: u32, height: u32) -> Result<Self> {
        let params = uniform_buffer(device, "luma size", &Params { width, height });
        let luma = storage_buffer(device, "luma", packed_bytes(width, height))?;
        let groups = [width.div_ceil(4).div_ceil(WORKGROUP[0]), height.div_ceil(WORKGROUP[1]), 1];
        let dispatch = Kernel::new(device, &stage()).dispatch(device, &[&params, pixels, &luma], groups);
        Ok(Self { dispatch, luma })
    }

    /// Records the conversion.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.dispatch.record(encoder);
    }

    /// The packed picture.
    pub fn luma(&self) -> &wgpu::Buffer {
        &self.luma
    }
}
