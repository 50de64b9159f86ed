//! Resampling of a view on a device.

use super::{WarpMap, kernels::warp::Warp};
use crate::{
    error::Result,
    gpu::{Gpu, Readback, buffer_of, guarded, storage_buffer},
    image::Luma,
    io::Picture,
    luma::{packed_bytes, unpack, upload},
};

/// Resamples packed luma, a picture of [`WarpMap::source_size`], by `map`, and returns the warped picture on the device and
/// on the host.
///
/// # Errors
/// [`crate::Error::TooLarge`], [`crate::Error::OutOfMemory`], [`crate::Error::DeviceLost`].
pub(crate) async fn warp(gpu: &Gpu, source: &wgpu::Buffer, map: &WarpMap) -> Result<(wgpu::Buffer, Luma)> {
    Resampler::new(gpu, map).await?.warp(source).await
}

/// Resamples the red, green and blue of `source`, a picture of [`WarpMap::source_size`], by `map`; alpha is 255.
///
/// # Errors
/// As [`warp`].
pub(crate) async fn warp_picture(gpu: &Gpu, source: &Picture, map: &WarpMap) -> Result<Picture> {
    let resampler = Resampler::new(gpu, map).await?;
    let channel = async |index: usize| -> Result<Luma> {
        let plane = source.map(|pixel| pixel[index]);
        Ok(resampler.warp(&upload(gpu, &plane).await?).await?.1)
    };
    let red = channel(0).await?;
    if source.data().iter().all(|&[red, green, blue, _]| red == green && green == blue) {
        return Ok(red.map(|&grey| [grey, grey, grey, 255]));
    }
    let (green, blue) = (channel(1).await?, channel(2).await?);
    Ok(Picture::from_fn(map.size(), |x, y| [red.get(x, y), green.get(x, y), blue.get(x, y), 255]))
}

/// The kernel and the nodes of a map on a device.
struct Resampler<'a> {
    gpu: &'a Gpu,
    map: &'a WarpMap,
    kernel: Warp,
    nodes: wgpu::Buffer,
}

impl<'a> Resampler<'a> {
    async fn new(gpu: &'a Gpu, map: &'a WarpMap) -> Result<Self> {
        let coordinates = map.node_coordinates();
        let (kernel, nodes) = guarded(gpu, "the map", || {
            let usage = wgpu::BufferUsages::STORAGE;
            let nodes = buffer_of(gpu, "nodes of the map", bytemuck::cast_slice(&coordinates), usage);
            Ok((Warp::new(gpu), nodes))
        })
        .await?;
        Ok(Self { gpu, map, kernel, nodes })
    }

    /// The warped picture on the device and on the host.
    async fn warp(&self, source: &wgpu::Buffer) -> Result<(wgpu::Buffer, Luma)> {
        let Self { gpu, map, kernel, nodes } = self;
        let bytes = packed_bytes(map.size());
        let (warped, readback) = guarded(gpu, "the warped picture", || {
            let warped = storage_buffer(gpu, "warped luma", bytes)?;
            let readback = Readback::new(gpu, "warped luma", bytes);
            let mut encoder = gpu.encoder("warp");
            kernel.prepare(map, source, nodes, &warped).record(&mut encoder);
            readback.record(&mut encoder, &warped);
            gpu.queue.submit([encoder.finish()]);
            Ok((warped, readback))
        })
        .await?;
        let words = readback.read((bytes / 4) as usize).await?;
        Ok((warped, unpack(map.size(), &words)))
    }
}
