//! Buffers: storage, uniforms, and buffers that are only copied.

use super::{Gpu, limits::BUFFER_LIMITS};
use crate::error::{Error, Result};

/// Creates a storage buffer that can also be copied from and to.
///
/// # Errors
/// [`Error::TooLarge`] if the device cannot bind the buffer.
pub(crate) fn storage_buffer(gpu: &Gpu, label: &'static str, bytes: u64) -> Result<wgpu::Buffer> {
    buffer_within(gpu, label, bytes, (bindable_bytes(gpu), BUFFER_LIMITS), wgpu::BufferUsages::STORAGE)
}

/// As [`storage_buffer`], with another usage: a buffer that kernels write and a renderer draws from.
///
/// # Errors
/// [`Error::TooLarge`] if the device cannot bind the buffer.
pub(crate) fn drawn_buffer(
    gpu: &Gpu,
    label: &'static str,
    bytes: u64,
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer> {
    buffer_within(gpu, label, bytes, (bindable_bytes(gpu), BUFFER_LIMITS), wgpu::BufferUsages::STORAGE | usage)
}

/// The largest storage buffer that the device can bind, in bytes.
fn bindable_bytes(gpu: &Gpu) -> u64 {
    let limits = gpu.device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// The largest storage buffer whose words a kernel can index with 32 bits, in bytes.
pub(crate) fn buffer_limit(gpu: &Gpu) -> u64 {
    bindable_bytes(gpu).min(1 << 32)
}

/// Creates a buffer that is only copied and never bound, so that it can exceed the binding size.
///
/// # Errors
/// [`Error::TooLarge`].
pub(crate) fn store(gpu: &Gpu, label: &'static str, bytes: u64) -> Result<wgpu::Buffer> {
    let limit = (gpu.device.limits().max_buffer_size, "max_buffer_size");
    buffer_within(gpu, label, bytes, limit, wgpu::BufferUsages::empty())
}

fn buffer_within(
    gpu: &Gpu,
    label: &'static str,
    bytes: u64,
    (limit, of): (u64, &str),
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer> {
    if bytes > limit {
        return Err(Error::TooLarge {
            what: label.into(),
            needed: bytes,
            limit,
            way_out: format!("use a smaller picture, or a device with more of {of}"),
        });
    }
    Ok(gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        // wgpu rejects empty bindings; copies need whole words.
        size: bytes.next_multiple_of(4).max(4),
        usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

/// Creates a uniform buffer initialised with `params`, so that recording writes nothing.
pub(crate) fn uniform_buffer<P: bytemuck::NoUninit>(gpu: &Gpu, label: &'static str, params: &P) -> wgpu::Buffer {
    buffer_of(gpu, label, bytemuck::bytes_of(params), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)
}

/// Creates a buffer initialised with `contents`, whole words.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn buffer_of(gpu: &Gpu, label: &'static str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = contents.len() as u64;
    let buffer =
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: true });
    // Without a mapped range, the device has already reported why: see `guarded`.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// Creates a buffer initialised with `contents`, whole words, in a browser. A buffer cannot be mapped at creation on a
/// lost device: `createBuffer` throws then, and wgpu panics. The write through the queue precedes everything submitted
/// later.
#[cfg(target_arch = "wasm32")]
pub(crate) fn buffer_of(gpu: &Gpu, label: &'static str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let size = contents.len() as u64;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    });
    if let (Some(device), Some(to)) = (gpu.device.as_webgpu(), buffer.as_webgpu()) {
        // The write throws only if the buffer is too small; all other errors reach the error scopes of `guarded`.
        let _ = device.queue().write_buffer_with_u32_and_u8_slice(to, 0, contents);
    }
    buffer
}
