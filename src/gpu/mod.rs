//! The bit of wgpu that every stage shares: choosing a device, building kernels, reading results.
//!
//! # The text that is compiled
//!
//! What a driver is given of a shader is not its file: constants and imported parts stand in front of it, and loops are
//! written out. With the environment variable `HSAD_DUMP_WGSL` set to a folder, which is created, each kernel that is
//! built also writes its text there, except in browsers: `<stage>-<hash of the text>.wgsl`, so that every variant of a
//! stage has a file. A file that cannot be written is a warning in the log and nothing more.

mod context;
mod device;
#[cfg(not(target_arch = "wasm32"))]
mod dump;
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
