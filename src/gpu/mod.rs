//! The wgpu layer that all stages share: the handle of a device, kernels, buffers, and readback of results.
//!
//! # The text that is compiled
//!
//! The driver does not get a shader's file as it is: constants and imported parts are put in front of it, and loops are
//! unrolled; for lavapipe, `main` copies the uniforms, and stores are rewritten. If the environment variable `HSAD_DUMP_WGSL` names a folder, which
//! is created, each compiled kernel also writes its WGSL there, as `<stage>-<hash of the text>.wgsl`, so that every variant
//! of a stage has its own file. A failed write is only a warning in the log. Browsers write no files.

#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
mod adapter_file;
#[cfg(not(target_arch = "wasm32"))]
mod background;
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
mod lavapipe;
mod limits;
mod pipeline;
#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
mod pipeline_file;
mod pipelines;
mod rates;
mod readback;
mod resources;
pub(crate) mod shader_struct;
mod shapes;
#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
mod shapes_file;
mod shelf;
pub(crate) mod stage;
mod stopwatch;
mod unroll;
mod waits;
mod warm_up;
pub(crate) mod word_texture;

#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
pub use adapter_file::cache_folder;
#[cfg(not(target_arch = "wasm32"))]
pub use block_on::block_on;
pub(crate) use buffers::{buffer_limit, buffer_of, drawn_buffer, storage_buffer, store, uniform_buffer};
pub use device::{DeviceChoice, list_adapters, pci_name};
pub(crate) use guard::{guarded, try_recording};
pub use handle::Gpu;
pub use kernel::DispatchSize;
pub(crate) use kernel::{Bindable, Dispatch, Kernel, record_run};
pub(crate) use limits::{BUFFER_LIMITS, MOST_TURNS, check_limits, check_turns};
pub use limits::{Limit, REQUIRED_LIMITS};
#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
pub use pipeline_file::PipelineFile;
pub use rates::Rates;
pub(crate) use readback::Readback;
pub(crate) use resources::{check_buffer, check_texture, refused};
pub(crate) use shader_struct::shader_struct;
pub(crate) use shader_struct::{Member, ShaderType, Shape};
pub use shapes::{Exchange, SgmPlan, Shapes, Windows};
#[cfg(all(feature = "files", not(target_arch = "wasm32")))]
pub use shapes_file::ShapesFile;
pub(crate) use stage::{Binding, Stage};
pub(crate) use stopwatch::Stopwatch;
pub(crate) use warm_up::warm_up;
pub(crate) use word_texture::{ROW_BITS, WordTexture, in_rows, most_words};
