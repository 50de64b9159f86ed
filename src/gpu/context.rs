//! What kernels are built on.

use std::ops::Deref;

/// A device, and the pipeline cache that its application keeps, if it does. It stands wherever a device does.
///
/// ```
/// use hsad::{dense::{DenseConfig, Matcher}, gpu::Context, wgpu};
///
/// fn matcher(device: &wgpu::Device, cache: &wgpu::PipelineCache, config: &DenseConfig) -> hsad::Result<Matcher> {
///     Matcher::new(Context { device, cache: Some(cache) }, (640, 480), config)
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Context<'a> {
    /// The device.
    pub device: &'a wgpu::Device,
    /// What compiled kernels are taken from and put into; of the same device.
    pub cache: Option<&'a wgpu::PipelineCache>,
}

impl<'a> From<&'a wgpu::Device> for Context<'a> {
    fn from(device: &'a wgpu::Device) -> Self {
        Self { device, cache: None }
    }
}

impl<'a> From<&Context<'a>> for Context<'a> {
    fn from(context: &Self) -> Self {
        *context
    }
}

impl Deref for Context<'_> {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        self.device
    }
}
