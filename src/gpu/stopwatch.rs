//! Durations of kernels, by timestamps of the device.

use std::time::Duration;

use super::{Gpu, Readback};
use crate::error::{Error, Result};

/// Timestamps before and after each kernel.
pub(crate) struct Stopwatch {
    queries: wgpu::QuerySet,
    kernels: u32,
    resolved: wgpu::Buffer,
    times: Readback,
}

impl Stopwatch {
    /// Creates timestamps for `kernels` kernels, or for as many of the first ones as a query set can hold.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if the device lacks `TIMESTAMP_QUERY`.
    pub(crate) fn new(gpu: &Gpu, kernels: usize) -> Result<Self> {
        let device = &gpu.device;
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(Error::Unsupported("it has no timestamps (Features::TIMESTAMP_QUERY)".into()));
        }
        let kernels = kernels.clamp(1, wgpu::QUERY_SET_MAX_QUERIES as usize / 2) as u32;
        let label = "timestamps";
        let bytes = u64::from(2 * kernels * wgpu::QUERY_SIZE);
        Ok(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some(label),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * kernels,
            }),
            kernels,
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            times: Readback::new(gpu, label, bytes),
        })
    }

    /// The timestamp writes of a kernel; `None` beyond the capacity of the query set.
    pub(crate) fn writes(&self, kernel: u32) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        (kernel < self.kernels).then_some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * kernel),
            end_of_pass_write_index: Some(2 * kernel + 1),
        })
    }

    /// Records the copy of the timestamps to the host, after the kernels.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2 * self.kernels, &self.resolved, 0);
        self.times.record(encoder, &self.resolved);
    }

    /// Returns the duration of each kernel, after the submission.
    ///
    /// # Errors
    /// [`Error::DeviceLost`].
    pub(crate) async fn read(&self, queue: &wgpu::Queue) -> Result<Vec<Duration>> {
        let ticks: Vec<u64> = self.times.read(2 * self.kernels as usize).await?;
        let seconds = f64::from(queue.get_timestamp_period()) / 1e9;
        let duration = |times: &[u64]| Duration::from_secs_f64(times[1].saturating_sub(times[0]) as f64 * seconds);
        Ok(ticks.chunks_exact(2).map(duration).collect())
    }
}
