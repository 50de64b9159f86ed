//! Buffers: storage, uniforms, and memory that is only copied.

use super::{Gpu, limits::BUFFER_LIMITS};
use crate::error::{Error, Result};

/// A storage buffer that a kernel fills or reads, and that can be copied from and to.
///
/// # Errors
/// [`Error::TooLarge`] where the device could not bind it.
pub(crate) fn storage_buffer(gpu: &Gpu, label: &'static str, bytes: u64) -> Result<wgpu::Buffer> {
    buffer_within(gpu, label, bytes, (bindable_bytes(gpu), BUFFER_LIMITS), wgpu::BufferUsages::STORAGE)
}

/// The largest storage buffer that the device can bind, in bytes.
fn bindable_bytes(gpu: &Gpu) -> u64 {
    let limits = gpu.device.limits();
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
}

/// The largest storage buffer of which a kernel can count the words in 32 bits, in bytes.
pub(crate) fn buffer_limit(gpu: &Gpu) -> u64 {
    bindable_bytes(gpu).min(1 << 32)
}

/// A buffer that no kernel sees, for what may be more than one can bind.
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
        // An empty binding is refused by wgpu; a copy needs whole words.
        size: bytes.next_multiple_of(4).max(4),
        usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    }))
}

/// A uniform buffer that holds `params` from the start, so that recording writes nothing.
pub(crate) fn uniform_buffer<P: bytemuck::NoUninit>(gpu: &Gpu, label: &'static str, params: &P) -> wgpu::Buffer {
    buffer_of(gpu, label, bytemuck::bytes_of(params), wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST)
}

/// A buffer that holds `contents`, whole words, from the start.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn buffer_of(gpu: &Gpu, label: &'static str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = contents.len() as u64;
    let buffer =
        gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: true });
    // Where there is nothing to be written to, the device has said why: see `guarded`.
    if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
        view.copy_from_slice(contents);
    }
    buffer.unmap();
    buffer
}

/// The same. What is mapped from the start cannot be had on a lost device: `createBuffer` throws then, and wgpu panics.
/// What the queue writes comes before all that is submitted later.
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
        // It throws only where the buffer is too small; everything else is told as `guarded` expects it.
        let _ = device.queue().write_buffer_with_u32_and_u8_slice(to, 0, contents);
    }
    buffer
}
