//! Words in a texture, for kernels that read many of them here and there: software drivers load those of all lanes at
//! once from a texture, and one after the other from a buffer. It is bound as a storage texture that is only read: that
//! has no mip levels, whose sizes lavapipe would work out for each lane of each load.

use super::Gpu;
use crate::error::{Error, Result};

/// Words of a row of the texture: the widest that every device has.
pub(crate) const ROW_BITS: u32 = 11;
const ROW: u32 = 1 << ROW_BITS;

/// Words of a buffer that holds at least so many in whole rows of a texture.
pub(crate) fn in_rows(words: u64) -> u64 {
    words.next_multiple_of(ROW.into())
}

/// The most words that a texture of the device holds.
pub(crate) fn most_words(gpu: &Gpu) -> u64 {
    u64::from(ROW) * u64::from(gpu.device.limits().max_texture_dimension_2d)
}

/// A texture that holds the words of a buffer, one after the other, as `shaders/shared/words.wgsl` reads them.
#[derive(Clone, Debug)]
pub struct WordTexture {
    texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

impl WordTexture {
    /// For so many words.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn new(gpu: &Gpu, label: &'static str, words: u64) -> Result<Self> {
        let limit = most_words(gpu);
        if words > limit {
            return Err(Error::TooLarge {
                what: label.into(),
                needed: 4 * words,
                limit: 4 * limit,
                way_out: "use a smaller picture, or a device with more of max_texture_dimension_2d".into(),
            });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: ROW,
                height: (in_rows(words.max(1)) / u64::from(ROW)) as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self { texture, view })
    }

    /// Fills it with the first words of `buffer`, which has as many whole rows.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * ROW), rows_per_image: None };
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer, layout },
            self.texture.as_image_copy(),
            self.texture.size(),
        );
    }
}
