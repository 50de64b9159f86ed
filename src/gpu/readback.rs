//! Readback of results through staging buffers.

use std::{
    sync::{Arc, Mutex, PoisonError},
    task::{Poll, Waker},
};

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

/// The state of a mapping, and the waker of the task that waits for it.
#[derive(Default)]
struct Mapping {
    result: Option<std::result::Result<(), String>>,
    /// Whether the future has taken the result.
    is_taken: bool,
    waiting: Option<Waker>,
}

impl Mapping {
    #[cfg(not(target_arch = "wasm32"))]
    fn is_pending(shared: &Mutex<Self>) -> bool {
        let mapping = shared.lock().unwrap_or_else(PoisonError::into_inner);
        mapping.result.is_none() && !mapping.is_taken
    }

    /// Sets the result, unless there is one already, and wakes the waiting task.
    fn finish(shared: &Mutex<Self>, result: std::result::Result<(), String>) {
        let mut mapping = shared.lock().unwrap_or_else(PoisonError::into_inner);
        if !mapping.is_taken {
            mapping.result.get_or_insert(result);
        }
        let waiting = mapping.waiting.take();
        drop(mapping);
        waiting.into_iter().for_each(Waker::wake);
    }
}

/// Maps `slice` for reading. Someone must poll the device for a mapping to finish: natively the future does, since the
/// application need not.
fn mapped(
    slice: wgpu::BufferSlice<'_>,
    device: &wgpu::Device,
) -> impl Future<Output = std::result::Result<(), String>> + use<> {
    let mapping = Arc::new(Mutex::new(Mapping::default()));
    let finished = mapping.clone();
    slice.map_async(wgpu::MapMode::Read, move |result| Mapping::finish(&finished, result.map_err(|e| e.to_string())));
    let mut undriven = Some(device.clone());
    std::future::poll_fn(move |context| {
        let take = |waiting: &Waker| {
            let mut mapping = mapping.lock().unwrap_or_else(PoisonError::into_inner);
            mapping.waiting = Some(waiting.clone());
            mapping.is_taken = mapping.result.is_some();
            mapping.result.take()
        };
        if let Some(result) = take(context.waker()) {
            return Poll::Ready(result);
        }
        if let Some(device) = undriven.take() {
            drive(device, &mapping);
        }
        take(context.waker()).map_or(Poll::Pending, Poll::Ready)
    })
}

/// Makes the device finish the mapping: at once if the work is done, else on a thread that waits for it, or on this
/// thread if none can be spawned.
#[cfg(not(target_arch = "wasm32"))]
fn drive(device: wgpu::Device, mapping: &Arc<Mutex<Mapping>>) {
    // A lost device is reported by the wait below.
    let _ = device.poll(wgpu::PollType::Poll);
    if !Mapping::is_pending(mapping) {
        return;
    }
    let (waiting_device, waiting_mapping) = (device.clone(), mapping.clone());
    let thread = std::thread::Builder::new().name("hsad readback".into());
    if thread.spawn(move || wait(&waiting_device, &waiting_mapping)).is_err() {
        wait(&device, mapping);
    }
}

/// Polls the device until the mapping is finished, at intervals that grow from 10 to 250 us. Waits are no substitute: a
/// wait is for everything submitted, and work submitted after the mapped buffer's must not delay the mapping; a wait that
/// times out while another thread finishes the queue panics in wgpu-core 30 and loses callbacks.
#[cfg(not(target_arch = "wasm32"))]
fn wait(device: &wgpu::Device, mapping: &Mutex<Mapping>) {
    const LONGEST: std::time::Duration = std::time::Duration::from_micros(250);
    let mut interval = std::time::Duration::from_micros(10);
    while Mapping::is_pending(mapping) {
        if let Err(error) = device.poll(wgpu::PollType::Poll) {
            Mapping::finish(mapping, Err(error.to_string()));
        }
        std::thread::sleep(interval);
        interval = LONGEST.min(interval * 3 / 2);
    }
}

/// A browser polls its devices itself.
#[cfg(target_arch = "wasm32")]
fn drive(_: wgpu::Device, _: &Arc<Mutex<Mapping>>) {}
