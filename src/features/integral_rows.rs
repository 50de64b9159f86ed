//! The integral image: sums of grey values over boxes in four reads (Viola and Jones, CVPR 2001).

use crate::{
    error::Result,
    gpu::{Binding, Kernel, Stage, storage_buffer, uniform_buffer},
};

const WORKGROUP: u32 = 64;

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Params {
    width: u32,
    height: u32,
}

/// The stage that sums along rows.
pub fn rows_stage() -> Stage {
    Stage {
        name: "integral_rows",
        source: include_str!("../../shaders/integral_rows.wgsl"),
        bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Read, Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into())],
    }
}

/// The stage that sums the row sums along columns.
pub fn columns_stage() -> Stage {
    Stage {
        name: "integral_columns",
        source: include_str!("../../shaders/integral_columns.wgsl"),
        bindings: &[Binding::Uniform(size_of::<Params>() as u64), Binding::Write],
        constants: vec![("WORKGROUP", WORKGROUP.into())],
    }
}

/// Bytes of a picture's integral image.
pub fn integral_bytes(width: u32, height: u32) -> u64 {
    4 * (u64::from(width) + 1) * (u64::from(height) + 1)
}

/// The integral image of pictures of one size.
pub struct Integral {
    rows: Kernel,
    rows_bind_group: wgpu::BindGroup,
    columns: Kernel,
    columns_bind_group: wgpu::BindGroup,
    width: u32,
    height: u32,
    integral: wgpu::Buffer,
}

impl Integral {
    /// Reads packed `luma`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] where the device cannot bind the integral image.
    pub fn new(device: &wgpu::Device, luma: &wgpu::Buffer, width: u32, height: u32) -> Result<Self> {
        let rows = Kernel::new(device, &rows_stage());
        let columns = Kernel::new(device, &columns_stage());
        let params = uniform_buffer(device, "integral image size", &Params { width, height });
        let integral = storage_buffer(device, "integral image", integral_bytes(width, height))?;
        let rows_bind_group = rows.bind(device, &[&params, luma, &integral]);
        let columns_bind_group = columns.bind(device, &[&params, &integral]);
        Ok(Self { rows, rows_bind_group, columns, columns_bind_group, width, height, integral })
    }

    /// Records both passes.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let groups = |threads: u32| [threads.div_ceil(WORKGROUP), 1, 1];
        self.rows.record(encoder, &self.rows_bind_group, groups(self.height + 1));
        self.columns.record(encoder, &self.columns_bind_group, groups(self.width + 1));
    }

    /// `height + 1` rows of `width + 1` sums, modulo 2^32: that of all rows and columns before.
    pub fn integral(&self) -> &wgpu::Buffer {
        &self.integral
    }
}
