//! Results on their way back to the host.

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

    /// Waits for the submitted work and returns the first `count` values.
    ///
    /// # Errors
    /// [`Error::DeviceLost`] where the device did not finish the work.
    pub(crate) fn read<T: bytemuck::Pod>(&self, device: &wgpu::Device, count: usize) -> Result<Vec<T>> {
        let lost = |why: &dyn std::fmt::Display| Error::DeviceLost(why.to_string());
        if count == 0 {
            return Ok(Vec::new());
        }
        let bytes = (count * size_of::<T>()) as u64;
        let slice = self.staging.slice(..bytes.next_multiple_of(4));
        let (send, receive) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // The receiver waits below for exactly this message.
            let _ = send.send(result);
        });
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| lost(&e))?;
        receive.recv().map_err(|e| lost(&e))?.map_err(|e| lost(&e))?;
        let view = slice.get_mapped_range().map_err(|e| lost(&e))?;
        let values = bytemuck::pod_collect_to_vec::<u8, T>(&view[..bytes as usize]);
        drop(view);
        self.staging.unmap();
        Ok(values)
    }
}
