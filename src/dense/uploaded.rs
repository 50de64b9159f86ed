//! A pair on a device, ready to be matched.

use super::kernels::Loss;
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

/// Which pixels of a pair show the scene: bytes packed as luma is, 255 or 0.
#[derive(Clone, Debug)]
pub(crate) struct Masks {
    pub own: wgpu::Buffer,
    pub other: wgpu::Buffer,
    /// What a pixel with a hidden partner loses before the refinement; after it the confidence.
    pub loss: Loss,
}

impl Masks {
    /// Uploads the masks of the reference view and of the other one, both of `size`; `None`: the whole view shows the scene.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn new(gpu: &Gpu, size: Size, [own, other]: [Option<&Luma>; 2], loss: Loss) -> Result<Self> {
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
