//! Error scopes: errors of the device as an [`Error`] instead of a call of the application's handler.

use std::sync::Arc;

#[cfg(not(target_arch = "wasm32"))]
use rayon::prelude::*;

use super::{Gpu, pipeline::Pipeline, pipelines::collect};
use crate::error::{Error, Result};

/// Whether the device is lost, which wgpu does not report by itself: nothing can be created on it any more.
#[cfg(not(target_arch = "wasm32"))]
fn is_lost(device: &wgpu::Device) -> bool {
    let usage = wgpu::BufferUsages::COPY_SRC;
    let probe = wgpu::BufferDescriptor { label: Some("probe"), size: 4, usage, mapped_at_creation: true };
    device.create_buffer(&probe).get_mapped_range_mut(..).is_err()
}

/// Always false in a browser, which reports a lost device only when results are read.
#[cfg(target_arch = "wasm32")]
fn is_lost(_: &wgpu::Device) -> bool {
    false
}

/// Runs `build`, which creates resources on the device, compiles the kernels that `build` is the first to ask for, and
/// turns errors of the device into an [`Error`] instead of a call of the application's error handler. The kernels are kept
/// for other builds if there was no error.
pub(crate) async fn guarded<T>(gpu: &Gpu, what: &str, build: impl FnOnce() -> Result<T>) -> Result<T> {
    let mut built = None;
    let errors = reported(gpu, what, Box::new(|| build().map(|result| built = Some(result))));
    errors.await?;
    Ok(built.expect("the result of a build without an error"))
}

/// [`guarded`] for builds of any type: code that is compiled once, and not for each of a program's futures.
fn reported<'a>(
    gpu: &'a Gpu,
    what: &'a str,
    build: Box<dyn FnOnce() -> Result<()> + '_>,
) -> impl Future<Output = Result<()>> + use<'a> {
    let scopes = Scopes::open(&gpu.device);
    let (built, new) = collect(|| refusing_other_instances(what, build));
    let mut errors = if built.is_ok() { compile(gpu, &new) } else { Vec::new() };
    let lost = is_lost(&gpu.device);
    let reports = scopes.close();
    async move {
        for error in reports {
            errors.extend(error.await);
        }
        if errors.iter().any(|error| matches!(error, wgpu::Error::OutOfMemory { .. })) {
            return Err(Error::OutOfMemory(what.into()));
        }
        // A lost device comes before the validation errors that follow from it.
        if lost {
            return Err(Error::DeviceLost(format!("{what}: nothing can be created on it any more")));
        }
        match errors.into_iter().next() {
            Some(error) => Err(Error::Unsupported(format!("{what}: {}", innermost(&error)))),
            None => built.map(|()| gpu.pipelines.keep(new)),
        }
    }
}

/// Compiles `pipelines` side by side, and returns the errors of the device.
#[cfg(not(target_arch = "wasm32"))]
fn compile(gpu: &Gpu, pipelines: &[Arc<Pipeline>]) -> Vec<wgpu::Error> {
    // Error scopes belong to threads, and their reports are ready at once.
    let errors_of = |pipeline: &Arc<Pipeline>| {
        let scopes = Scopes::open(&gpu.device);
        pipeline.compiled(gpu);
        scopes.close().into_iter().filter_map(super::block_on).collect::<Vec<_>>()
    };
    pipelines.par_iter().with_max_len(1).flat_map_iter(errors_of).collect()
}

/// Compiles `pipelines`; errors go to the scopes of the caller. In a browser there is one thread, and the browser
/// compiles on others.
#[cfg(target_arch = "wasm32")]
fn compile(gpu: &Gpu, pipelines: &[Arc<Pipeline>]) -> Vec<wgpu::Error> {
    for pipeline in pipelines {
        pipeline.compiled(gpu);
    }
    Vec::new()
}

/// The cause of a device's error: wgpu wraps it in the names of the calls that led there.
fn innermost(error: &dyn std::error::Error) -> &dyn std::error::Error {
    error.source().map_or(error, innermost)
}

/// Runs `build`, with an [`Error`] for a resource of another [`wgpu::Instance`], for which wgpu panics.
#[cfg(not(target_arch = "wasm32"))]
fn refusing_other_instances(what: &str, build: Box<dyn FnOnce() -> Result<()> + '_>) -> Result<()> {
    use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

    // Nothing that `build` leaves half done is used afterwards.
    catch_unwind(AssertUnwindSafe(build)).unwrap_or_else(|panic| {
        // The texts of wgpu-core's storage, where resources of one instance are looked up by index.
        let unknown = ["non-existent resource", "found other resource"];
        match panic.downcast_ref::<String>() {
            Some(text) if unknown.iter().any(|part| text.contains(part)) => {
                Err(Error::Unsupported(format!("{what}: a resource belongs to another wgpu::Instance")))
            }
            _ => resume_unwind(panic),
        }
    })
}

/// The same. In a browser there is one instance.
#[cfg(target_arch = "wasm32")]
fn refusing_other_instances(_: &str, build: Box<dyn FnOnce() -> Result<()> + '_>) -> Result<()> {
    build()
}

/// Error scopes of the thread, of which the inner ones come first.
struct Scopes([wgpu::ErrorScopeGuard; 3]);

impl Scopes {
    fn open(device: &wgpu::Device) -> Self {
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        Self([internal, memory, validation])
    }

    /// Futures of the device's errors. The scopes are closed before those futures are awaited, so that they catch no error of
    /// other work.
    fn close(self) -> [impl Future<Output = Option<wgpu::Error>>; 3] {
        self.0.map(wgpu::ErrorScopeGuard::pop)
    }
}

/// Records commands that are never submitted, so that validation errors come here and not when a caller records them. A
/// buffer of another device, for example, is only noticed this way.
pub(crate) async fn try_recording(gpu: &Gpu, what: &str, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<()> {
    guarded(gpu, what, || {
        let mut encoder = gpu.encoder("trial");
        record(&mut encoder);
        drop(encoder.finish());
        Ok(())
    })
    .await
}
