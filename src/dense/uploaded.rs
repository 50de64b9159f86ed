//! A pair on a device, ready to be matched.

use super::{kernels::Loss, seen::Seen};
use crate::{
    error::Result,
    gpu::{Gpu, storage_buffer},
    image::{Luma, Size},
    luma::{Colours, pack, packed_bytes},
};

/// A pair on a device.
#[derive(Clone, Debug)]
pub(crate) struct UploadedPair {
    /// Packed luma, left and right.
    pub luma: [wgpu::Buffer; 2],
    /// The colours of the reference view, if it has any.
    pub colours: Option<Colours>,
    /// Which pixels show the scene, unless all do.
    pub masks: Option<Masks>,
}

impl UploadedPair {
    /// Memory for a pair of the `size` of this one.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn another(&self, gpu: &Gpu, size: Size) -> Result<Self> {
        let buffer = |label| storage_buffer(gpu, label, packed_bytes(size));
        let masks = |masks: &Masks| -> Result<Masks> {
            Ok(Masks { own: buffer("mask")?, other: buffer("mask")?, loss: masks.loss })
        };
        Ok(Self {
            luma: [buffer("left luma")?, buffer("right luma")?],
            colours: self.colours.as_ref().map(|_| Colours::new(gpu, size)).transpose()?,
            masks: self.masks.as_ref().map(masks).transpose()?,
        })
    }

    /// Records the copy to a pair of the same size, with colours and masks if this one has them.
    pub fn copy_to(&self, to: &Self, encoder: &mut wgpu::CommandEncoder) {
        for (from, to) in self.buffers().zip(to.buffers()) {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, None);
        }
    }

    fn buffers(&self) -> impl Iterator<Item = &wgpu::Buffer> {
        let colours = self.colours.iter().flat_map(|colours| colours.bands().map(|(.., band)| band));
        let masks = self.masks.iter().flat_map(|masks| [&masks.own, &masks.other]);
        self.luma.iter().chain(colours).chain(masks)
    }
}

/// Which pixels of a pair show the scene: bytes packed as luma is, 255 or 0.
#[derive(Clone, Debug)]
pub(crate) struct Masks {
    pub own: wgpu::Buffer,
    pub other: wgpu::Buffer,
    /// What a pixel with a hidden partner loses before the refinement; after it the confidence.
    pub loss: Loss,
}

impl Masks {
    /// Uploads the masks of a pair of `size`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn new(gpu: &Gpu, size: Size, Seen { masks: [own, other], loss }: Seen<'_>) -> Result<Self> {
        let uploaded = |mask: Option<&Luma>| -> Result<wgpu::Buffer> {
            let buffer = storage_buffer(gpu, "mask", packed_bytes(size))?;
            let words = mask.map_or_else(|| vec![u32::MAX; (packed_bytes(size) / 4) as usize], pack);
            gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
            Ok(buffer)
        };
        Ok(Self { own: uploaded(own)?, other: uploaded(other)?, loss })
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.own.size() + self.other.size()
    }
}
