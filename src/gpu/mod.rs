//! The bit of wgpu that every stage shares: choosing a device, building kernels, reading results.

mod device;
mod kernel;
mod readback;
mod shader_struct;
mod unroll;

pub use device::{DeviceChoice, Gpu, list_adapters};
pub use kernel::{Binding, Dispatch, Stage};
pub(crate) use kernel::{Kernel, guarded, storage_buffer, store, uniform_buffer};
pub(crate) use readback::Readback;
pub(crate) use shader_struct::shader_struct;
pub use shader_struct::{Member, ShaderType, Shape};
