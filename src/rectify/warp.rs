//! Resampling of a view on a device.

use super::{WarpMap, kernels::warp::Warp};
use crate::{
    error::Result,
    gpu::{Gpu, Readback, buffer_of, guarded, storage_buffer},
    image::Luma,
    luma::{packed_bytes, unpack},
};

/// Resamples packed luma, a picture of [`WarpMap::source_size`], by `map`, and returns the warped picture on the device and
/// on the host.
///
/// # Errors
/// [`crate::Error::TooLarge`], [`crate::Error::OutOfMemory`], [`crate::Error::DeviceLost`].
pub(crate) async fn warp(gpu: &Gpu, source: &wgpu::Buffer, map: &WarpMap) -> Result<(wgpu::Buffer, Luma)> {
    let bytes = packed_bytes(map.size());
    let (warped, readback) = guarded(gpu, "the warped picture", || {
        let warped = storage_buffer(gpu, "warped luma", bytes)?;
        let coordinates = map.node_coordinates();
        let nodes = buffer_of(gpu, "nodes of the map", bytemuck::cast_slice(&coordinates), wgpu::BufferUsages::STORAGE);
        let readback = Readback::new(gpu, "warped luma", bytes);
        let mut encoder = gpu.encoder("warp");
        Warp::new(gpu).prepare(map, source, &nodes, &warped).record(&mut encoder);
        readback.record(&mut encoder, &warped);
        gpu.queue.submit([encoder.finish()]);
        Ok((warped, readback))
    })
    .await?;
    let words = readback.read((bytes / 4) as usize).await?;
    Ok((warped, unpack(map.size(), &words)))
}
