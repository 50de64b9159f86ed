//! What the device has to say about what is created on it, as an [`Error`] instead of a call of the application's handler.

use super::Gpu;
use crate::error::{Error, Result};

/// Whether the device creates nothing any more, which it does not say by itself.
#[cfg(not(target_arch = "wasm32"))]
fn is_lost(device: &wgpu::Device) -> bool {
    let usage = wgpu::BufferUsages::COPY_SRC;
    let probe = wgpu::BufferDescriptor { label: Some("probe"), size: 4, usage, mapped_at_creation: true };
    device.create_buffer(&probe).get_mapped_range_mut(..).is_err()
}

/// The same. A browser creates as if nothing had happened, and says it only where results are to be read.
#[cfg(target_arch = "wasm32")]
fn is_lost(_: &wgpu::Device) -> bool {
    false
}

/// Runs `build`, which creates things on a device, and turns what the device has to say about it
/// into an [`Error`] instead of a call of the application's error handler.
pub(crate) async fn guarded<T>(gpu: &Gpu, what: &str, build: impl FnOnce() -> Result<T>) -> Result<T> {
    let ((built, lost), said) = scoped(&gpu.device, || (refusing_other_instances(what, build), is_lost(&gpu.device)));
    let mut errors = Vec::new();
    for error in said {
        errors.extend(error.await);
    }
    if errors.iter().any(|error| matches!(error, wgpu::Error::OutOfMemory { .. })) {
        return Err(Error::OutOfMemory(what.into()));
    }
    // Before what else is said then: it is about what was not created.
    if lost {
        return Err(Error::DeviceLost(format!("{what}: nothing can be created on it any more")));
    }
    match errors.into_iter().next() {
        Some(error) => Err(Error::Unsupported(format!("{what}: {}", innermost(&error)))),
        None => built,
    }
}

/// The cause of a device's error: wgpu wraps it in the names of the calls that led there.
fn innermost(error: &dyn std::error::Error) -> &dyn std::error::Error {
    error.source().map_or(error, innermost)
}

/// Runs `build`, with an [`Error`] for a resource of another [`wgpu::Instance`], for which wgpu panics.
#[cfg(not(target_arch = "wasm32"))]
fn refusing_other_instances<T>(what: &str, build: impl FnOnce() -> Result<T>) -> Result<T> {
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
fn refusing_other_instances<T>(_: &str, build: impl FnOnce() -> Result<T>) -> Result<T> {
    build()
}

/// What `build` returns, and what the device will have to say. Whatever else happens before that is known lies outside
/// the scopes: they have ended.
fn scoped<T>(device: &wgpu::Device, build: impl FnOnce() -> T) -> (T, [impl Future<Output = Option<wgpu::Error>>; 3]) {
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let built = build();
    (built, [internal.pop(), memory.pop(), validation.pop()])
}

/// Records what is never submitted: what the device would have to say when a caller records it, it says here. A buffer of
/// another device, for one, cannot be told otherwise.
pub(crate) async fn try_recording(gpu: &Gpu, what: &str, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<()> {
    guarded(gpu, what, || {
        let mut encoder = gpu.encoder("trial");
        record(&mut encoder);
        drop(encoder.finish());
        Ok(())
    })
    .await
}
