//! Readback of results through staging buffers.

use std::sync::{Arc, Mutex, PoisonError};
#[cfg(target_arch = "wasm32")]
use std::task::{Poll, Waker};
#[cfg(not(target_arch = "wasm32"))]
use std::{
    sync::{Condvar, MutexGuard},
    time::Duration,
};

#[cfg(not(target_arch = "wasm32"))]
use super::background::in_background;
use super::{Gpu, waits::Waits};
use crate::error::{Error, Result};

/// A staging buffer for the first bytes of a buffer: the copy is recorded with the work and read after its submission.
#[derive(Debug)]
pub(crate) struct Readback {
    staging: wgpu::Buffer,
    device: wgpu::Device,
    waits: Arc<Waits>,
}

impl Readback {
    /// Creates a staging buffer of `bytes` bytes.
    pub(crate) fn new(gpu: &Gpu, label: &'static str, bytes: u64) -> Self {
        let device = gpu.device.clone();
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(4).max(4),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { staging, device, waits: gpu.waits.clone() }
    }

    /// Records the copy of `source`'s first bytes.
    pub(crate) fn record(&self, encoder: &mut wgpu::CommandEncoder, source: &wgpu::Buffer) {
        encoder.copy_buffer_to_buffer(source, 0, &self.staging, 0, Some(self.staging.size().min(source.size())));
    }

    /// The staging buffer, the destination of copies.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.staging
    }

    /// Waits for the submitted work and returns the first `count` values.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] if the device did not finish the work.
    pub(crate) async fn read<T: bytemuck::Pod>(&self, count: usize) -> Result<Vec<T>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = (count * size_of::<T>()) as u64;
        let slice = self.staging.slice(..bytes.next_multiple_of(4));
        let wait = self.waits.begin();
        let unmap = Unmap(&self.staging);
        if let Err(reason) = mapped(slice, &self.device).await {
            // Nothing is mapped.
            std::mem::forget(unmap);
            return Err(Error::DeviceLost(reason));
        }
        drop(wait);
        let view = slice.get_mapped_range().map_err(|e| Error::DeviceLost(e.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec::<u8, T>(&view[..bytes as usize]))
    }
}

/// Unmaps a buffer at the end of a read, also of a read that is cancelled while its mapping is pending.
struct Unmap<'a>(&'a wgpu::Buffer);

impl Drop for Unmap<'_> {
    fn drop(&mut self) {
        self.0.unmap();
    }
}

/// Maps `slice` for reading. Someone must poll the device for a mapping to finish: a thread does, since the application need not.
///
/// The thread holds the device. The future is not ready before the thread has dropped it: else the device could be destroyed while the
/// process ends, which crashes drivers.
#[cfg(not(target_arch = "wasm32"))]
async fn mapped(slice: wgpu::BufferSlice<'_>, device: &wgpu::Device) -> std::result::Result<(), String> {
    let mapping = Arc::new(Mapping::default());
    let finished = mapping.clone();
    slice.map_async(wgpu::MapMode::Read, move |result| finished.finish(result.map_err(|error| error.to_string())));
    // A lost device is reported by the thread's poll.
    let _ = device.poll(wgpu::PollType::Poll);
    if mapping.is_pending() {
        let (device, mapping) = (device.clone(), mapping.clone());
        in_background(move || mapping.drive(&device)).await;
    }
    mapping.result().take().expect("a mapping that is finished")
}

/// The result of a mapping.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Default)]
struct Mapping {
    result: Mutex<Option<std::result::Result<(), String>>>,
    finished: Condvar,
}

#[cfg(not(target_arch = "wasm32"))]
impl Mapping {
    fn result(&self) -> MutexGuard<'_, Option<std::result::Result<(), String>>> {
        self.result.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_pending(&self) -> bool {
        self.result().is_none()
    }

    /// Sets the result, unless there is one already.
    fn finish(&self, result: std::result::Result<(), String>) {
        self.result().get_or_insert(result);
        self.finished.notify_all();
    }

    /// Polls the device until the mapping is finished, by this thread or by another one, at intervals that grow from 10 to 250 us. Waits of
    /// the device are no substitute: such a wait is for everything submitted, and work submitted after the mapped buffer's must not delay
    /// the mapping; a wait that times out while another thread finishes the queue panics in wgpu-core 30 and loses callbacks.
    fn drive(&self, device: &wgpu::Device) {
        const LONGEST: Duration = Duration::from_micros(250);
        let mut interval = Duration::from_micros(10);
        while self.is_pending() {
            if let Err(error) = device.poll(wgpu::PollType::Poll) {
                self.finish(Err(error.to_string()));
            }
            let waited = self.finished.wait_timeout_while(self.result(), interval, |result| result.is_none());
            drop(waited);
            interval = LONGEST.min(interval * 3 / 2);
        }
    }
}

/// Maps `slice` for reading. A browser polls its devices itself.
#[cfg(target_arch = "wasm32")]
fn mapped(
    slice: wgpu::BufferSlice<'_>,
    _: &wgpu::Device,
) -> impl Future<Output = std::result::Result<(), String>> + use<> {
    #[derive(Default)]
    struct Mapping {
        result: Option<std::result::Result<(), String>>,
        waiting: Option<Waker>,
    }
    let mapping = Arc::new(Mutex::new(Mapping::default()));
    let finished = mapping.clone();
    slice.map_async(wgpu::MapMode::Read, move |result| {
        let mut mapping = finished.lock().unwrap_or_else(PoisonError::into_inner);
        mapping.result = Some(result.map_err(|error| error.to_string()));
        let waiting = mapping.waiting.take();
        drop(mapping);
        waiting.into_iter().for_each(Waker::wake);
    });
    std::future::poll_fn(move |context| {
        let mut mapping = mapping.lock().unwrap_or_else(PoisonError::into_inner);
        mapping.waiting = Some(context.waker().clone());
        mapping.result.take().map_or(Poll::Pending, Poll::Ready)
    })
}
