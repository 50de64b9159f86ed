//! The first half of the integral image, which gives sums of grey values over boxes in four reads
//! (Viola and Jones, CVPR 2001): sums along rows. `shaders/features/integral_rows.wgsl`.

use crate::{
    error::Result,
    gpu::{Binding, Context, Dispatch, Kernel, ShaderType, Stage, shader_struct, storage_buffer, uniform_buffer},
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

/// The row sums of pictures of one size.
pub struct IntegralRows {
    dispatch: Dispatch,
    sums: wgpu::Buffer,
}

impl IntegralRows {
    /// Reads packed `luma`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind the sums.
    pub fn new(device: &Context<'_>, luma: &wgpu::Buffer, width: u32, height: u32) -> Result<Self> {
        let params = uniform_buffer(device, "integral_rows", &Params { width, height });
        let sums = storage_buffer(device, "integral image", 4 * (u64::from(width) + 1) * (u64::from(height) + 1))?;
        let groups = [(height + 1).div_ceil(WORKGROUP), 1, 1];
        let dispatch = Kernel::new(device, &stage()).dispatch(device, &[&params, luma, &sums], groups);
        Ok(Self { dispatch, sums })
    }

    /// Records the pass.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.dispatch.record(encoder);
    }

    /// `height + 1` rows of `width + 1` sums, row 0 and column 0 being 0.
    pub fn sums(&self) -> &wgpu::Buffer {
        &self.sums
    }
}
