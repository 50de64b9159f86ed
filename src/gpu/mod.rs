//! The bit of wgpu that every stage shares: choosing a device, building kernels, reading results.

mod context;
mod device;
mod kernel;
mod limits;
mod readback;
mod shader_struct;
mod unroll;
mod words;

pub use context::Context;
pub use device::{DeviceChoice, Gpu, list_adapters};
pub(crate) use kernel::{Bindable, Kernel, buffer_of, guarded, storage_buffer, store, uniform_buffer};
pub use kernel::{Binding, Dispatch, Stage};
pub(crate) use limits::check_limits;
pub use limits::{Limit, REQUIRED_LIMITS};
pub(crate) use readback::Readback;
pub(crate) use shader_struct::shader_struct;
pub use shader_struct::{Member, ShaderType, Shape};
pub use words::WordTexture;
pub(crate) use words::{ROW_BITS, in_rows, most_words};
