//! The part of wgpu that every stage shares: a handle on a device, kernels, buffers, and results that are read back.
//!
//! # The text that is compiled
//!
//! A driver is not given a shader's file: constants and imported parts stand in front of it, and loops are unrolled. With
//! the environment variable `HSAD_DUMP_WGSL` set to a folder, which is created, each kernel that is built also writes its
//! text there, except in browsers: `<stage>-<hash of the text>.wgsl`, so that every variant of a stage has a file. A file
//! that cannot be written is a warning in the log and nothing more.

#[cfg(not(target_arch = "wasm32"))]
mod block_on;
mod buffers;
mod device;
#[cfg(not(target_arch = "wasm32"))]
mod dump;
mod guard;
mod handle;
mod imports;
pub(crate) mod kernel;
mod limits;
mod readback;
mod resources;
pub(crate) mod shader_struct;
pub(crate) mod stage;
mod stopwatch;
mod unroll;
pub(crate) mod word_texture;

#[cfg(not(target_arch = "wasm32"))]
pub use block_on::block_on;
pub(crate) use buffers::{buffer_limit, buffer_of, storage_buffer, store, uniform_buffer};
pub use device::{DeviceChoice, list_adapters};
pub(crate) use guard::{guarded, try_recording};
pub use handle::Gpu;
pub(crate) use kernel::{Bindable, Dispatch, Kernel};
pub(crate) use limits::{BUFFER_LIMITS, check_limits};
pub use limits::{Limit, REQUIRED_LIMITS};
pub(crate) use readback::Readback;
pub(crate) use resources::{check_buffer, check_texture, refused_view};
pub(crate) use shader_struct::shader_struct;
pub(crate) use shader_struct::{Member, ShaderType, Shape};
pub(crate) use stage::{Binding, Stage};
pub(crate) use stopwatch::Stopwatch;
pub(crate) use word_texture::{ROW_BITS, WordTexture, in_rows, most_words};
