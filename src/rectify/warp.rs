//! Resampling of views on a device.

use super::{
    WarpMap,
    kernels::{warp::Warp, warp_colours::WarpColours},
};
use crate::{
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Dispatch, Gpu, Readback, buffer_of, storage_buffer},
    image::{Luma, Size},
    io::Picture,
    luma::{Colours, packed_bytes, unpack, upload},
};

/// A map on a device.
#[derive(Debug)]
pub(crate) struct UploadedMap<'m> {
    gpu: &'m Gpu,
    pub map: &'m WarpMap,
    pub nodes: wgpu::Buffer,
}

impl<'m> UploadedMap<'m> {
    /// Uploads the nodes of `map`.
    pub fn new(gpu: &'m Gpu, map: &'m WarpMap) -> Self {
        let coordinates = map.node_coordinates();
        let contents = bytemuck::cast_slice(&coordinates);
        Self { gpu, map, nodes: buffer_of(gpu, "nodes of the map", contents, wgpu::BufferUsages::STORAGE) }
    }

    /// Resamples packed luma `source`, a picture of [`WarpMap::source_size`], to `warped`.
    pub fn luma(&self, source: &wgpu::Buffer, warped: &wgpu::Buffer) -> Dispatch {
        Warp::new(self.gpu).prepare(self.map, source, &self.nodes, warped)
    }

    /// Resamples the colours of a picture of [`WarpMap::source_size`] to `warped`, of [`WarpMap::size`].
    ///
    /// # Errors
    /// [`Error::TooLarge`] if the device cannot bind `source` whole.
    pub fn colours(&self, source: &Colours, warped: &Colours) -> Result<Vec<Dispatch>> {
        let mut bands = source.bands();
        let (Some((_, _, whole)), None) = (bands.next(), bands.next()) else {
            return Err(Error::TooLarge {
                what: format!("the resampling of a picture of {} pixels in colour", self.map.source_size()),
                needed: source.bytes(),
                limit: self.gpu.device.limits().max_storage_buffer_binding_size,
                way_out: format!(
                    "fill no holes, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"
                ),
            });
        };
        let kernel = WarpColours::new(self.gpu);
        let band = |(first_row, size, pixels): (u32, Size, &wgpu::Buffer)| {
            kernel.prepare(self.map, [first_row, size.height], whole, &self.nodes, pixels)
        };
        Ok(warped.bands().map(band).collect())
    }
}

/// Resamples packed luma, a picture of [`WarpMap::source_size`], by `map`, and returns the warped picture on the device and
/// on the host.
///
/// # Errors
/// [`Error::TooLarge`], [`Error::OutOfMemory`], [`Error::DeviceLost`].
pub(crate) async fn warp(gpu: &Gpu, source: &wgpu::Buffer, map: &WarpMap) -> Result<(wgpu::Buffer, Luma)> {
    let bytes = packed_bytes(map.size());
    let (warped, readback) = gpu
        .with_room("the warped picture", || {
            let warped = storage_buffer(gpu, "warped luma", bytes)?;
            let readback = Readback::new(gpu, "warped luma", bytes);
            let mut encoder = gpu.encoder("warp");
            UploadedMap::new(gpu, map).luma(source, &warped).record(&mut encoder);
            readback.record(&mut encoder, &warped);
            gpu.queue.submit([encoder.finish()]);
            Ok((warped, readback))
        })
        .await?;
    let words = readback.read((bytes / 4) as usize).await?;
    Ok((warped, unpack(map.size(), &words)))
}

/// Resamples the red, green and blue of `source`, a picture of [`WarpMap::source_size`], by `map`; alpha is 255. Pixels that show
/// nothing of the source are 0.
///
/// # Errors
/// As [`warp`].
pub(crate) async fn warp_colours(gpu: &Gpu, source: &Picture, map: &WarpMap) -> Result<Picture> {
    let begun = gpu
        .with_room("the warped picture", || {
            let colours = Colours::new(gpu, source.size())?;
            if colours.bands().count() > 1 {
                return Ok(None);
            }
            colours.write(gpu, source);
            let warped = Colours::new(gpu, map.size())?;
            let mut encoder = gpu.encoder("warp in colour");
            UploadedMap::new(gpu, map).colours(&colours, &warped)?.iter().for_each(|one| one.record(&mut encoder));
            let bands = warped.bands().map(|(_, _, pixels)| {
                let readback = Readback::new(gpu, "warped colours", pixels.size());
                readback.record(&mut encoder, pixels);
                (readback, pixels.size())
            });
            let bands: Vec<_> = bands.collect();
            gpu.queue.submit([encoder.finish()]);
            Ok(Some(bands))
        })
        .await?;
    let Some(bands) = begun else { return channel_by_channel(gpu, source, map).await };
    let mut pixels: Vec<[u8; 4]> = Vec::with_capacity(map.size().pixels() as usize);
    for (readback, bytes) in bands {
        pixels.extend(readback.read::<[u8; 4]>((bytes / 4) as usize).await?);
    }
    Picture::new(map.size(), pixels)
}

/// [`warp_colours`] where the device cannot bind the source whole.
async fn channel_by_channel(gpu: &Gpu, source: &Picture, map: &WarpMap) -> Result<Picture> {
    let channel = async |index: usize| -> Result<Luma> {
        Ok(warp(gpu, &upload(gpu, &source.map(|pixel| pixel[index])).await?, map).await?.1)
    };
    let [red, green, blue] = [channel(0).await?, channel(1).await?, channel(2).await?];
    let visible = map.visible();
    Ok(Picture::from_fn(map.size(), |x, y| match visible.get(x, y) {
        0 => [0; 4],
        alpha => [red.get(x, y), green.get(x, y), blue.get(x, y), alpha],
    }))
}
