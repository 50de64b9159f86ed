//! Results on their way back to the host.

use std::{
    sync::{Arc, Mutex, PoisonError},
    task::{Poll, Waker},
};

use crate::error::{Error, Result};

/// A host-visible copy of a buffer's first bytes: recorded with the work, read after its submission.
pub(crate) struct Readback {
    staging: wgpu::Buffer,
}

impl Readback {
    /// Space for `bytes`.
    pub(crate) fn new(device: &wgpu::Device, label: &'static str, bytes: u64) -> Self {
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(4).max(4),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { staging }
    }

    /// Records the copy of `source`'s first bytes.
    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder, source: &wgpu::Buffer) {
        encoder.copy_buffer_to_buffer(source, 0, &self.staging, 0, Some(self.staging.size().min(source.size())));
    }

    /// The buffer to copy to.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.staging
    }

    /// The first `count` values, once the submitted work is done.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] where the device did not finish the work.
    pub(crate) async fn read<T: bytemuck::Pod>(&self, count: usize) -> Result<Vec<T>> {
        let lost = |why: &dyn std::fmt::Display| Error::DeviceLost(why.to_string());
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = (count * size_of::<T>()) as u64;
        let slice = self.staging.slice(..bytes.next_multiple_of(4));
        mapped(slice).await.map_err(|e| lost(&e))?;
        let view = slice.get_mapped_range().map_err(|e| lost(&e))?;
        let values = bytemuck::pod_collect_to_vec::<u8, T>(&view[..bytes as usize]);
        drop(view);
        self.staging.unmap();
        Ok(values)
    }
}

/// What a mapping has come to so far, and who waits for it.
#[derive(Default)]
struct Mapping {
    result: Option<std::result::Result<(), wgpu::BufferAsyncError>>,
    waiting: Option<Waker>,
}

/// Maps `slice` for reading. Natively whoever polls the device, or submits work to its queue, gets it done.
fn mapped(slice: wgpu::BufferSlice<'_>) -> impl Future<Output = std::result::Result<(), wgpu::BufferAsyncError>> {
    let mapping = Arc::new(Mutex::new(Mapping::default()));
    let change = mapping.clone();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        let mut mapping = change.lock().unwrap_or_else(PoisonError::into_inner);
        mapping.result = Some(result);
        let waiting = mapping.waiting.take();
        drop(mapping);
        waiting.into_iter().for_each(Waker::wake);
    });
    std::future::poll_fn(move |context| {
        let mut mapping = mapping.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(result) = mapping.result.take() {
            return Poll::Ready(result);
        }
        mapping.waiting = Some(context.waker().clone());
        Poll::Pending
    })
}
