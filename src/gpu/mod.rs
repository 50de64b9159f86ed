//! The bit of wgpu that every stage shares: choosing a device, building kernels, reading results.

mod context;
mod device;
mod imports;
mod kernel;
mod limits;
mod readback;
mod shader_struct;
mod stopwatch;
mod unroll;
#[cfg(not(target_arch = "wasm32"))]
mod wait;
mod words;

pub use context::Context;
pub(crate) use device::is_lavapipe;
#[cfg(not(target_arch = "wasm32"))]
pub use device::list_adapters;
pub use device::{DeviceChoice, Gpu, list_adapters_async};
pub(crate) use kernel::{Bindable, Kernel, buffer_of, guarded, storage_buffer, store, uniform_buffer};
pub use kernel::{Binding, Dispatch, Stage};
pub(crate) use limits::{BUFFER_LIMITS, check_limits};
pub use limits::{Limit, REQUIRED_LIMITS};
pub(crate) use readback::Readback;
pub(crate) use shader_struct::shader_struct;
pub use shader_struct::{Member, ShaderType, Shape};
pub(crate) use stopwatch::Stopwatch;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use wait::wait;
pub use words::WordTexture;
pub(crate) use words::{ROW_BITS, in_rows, most_words};
