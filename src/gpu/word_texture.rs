//! Words in a texture, for kernels with scattered reads: software drivers load the words of all lanes at once from a
//! texture, but one after the other from a buffer. The texture is bound as a read-only storage texture, which has no
//! mip levels; lavapipe would compute their sizes for each lane of each load.

use super::Gpu;
use crate::error::{Error, Result};

/// Base-2 logarithm of the words per texture row: 2,048, the largest width that every device supports.
pub(crate) const ROW_BITS: u32 = 11;
const ROW: u32 = 1 << ROW_BITS;

/// Rounds `words` up to whole texture rows.
pub(crate) fn in_rows(words: u64) -> u64 {
    words.next_multiple_of(ROW.into())
}

/// The most words of a texture of the device.
pub(crate) fn most_words(gpu: &Gpu) -> u64 {
    u64::from(ROW) * u64::from(gpu.device.limits().max_texture_dimension_2d)
}

/// A texture that holds the words of a buffer, one after the other, as `shaders/shared/words.wgsl` reads them.
#[derive(Clone, Debug)]
pub struct WordTexture {
    texture: wgpu::Texture,
    words: u64,
    pub(crate) view: wgpu::TextureView,
}

impl WordTexture {
    /// Creates a texture of `words` words.
    ///
    /// # Errors
    /// [`Error::TooLarge`] if `max_texture_dimension_2d` does not allow so many words.
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
        Ok(Self { texture, words, view })
    }

    /// Writes `words` at the beginning of the texture, before everything that is submitted later.
    pub(crate) fn write(&self, gpu: &Gpu, mut words: Vec<u32>) {
        words.resize(in_rows(words.len() as u64) as usize, 0);
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(&words),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * ROW), rows_per_image: None },
            wgpu::Extent3d { width: ROW, height: words.len() as u32 / ROW, depth_or_array_layers: 1 },
        );
    }

    /// Records the copy of the first words of `buffer`, which must hold as many as the texture, to the texture.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer) {
        let (rows, rest) = ((self.words / u64::from(ROW)) as u32, (self.words % u64::from(ROW)) as u32);
        let mut copy = |y: u32, width: u32, height: u32| {
            if width == 0 || height == 0 {
                return;
            }
            let offset = 4 * u64::from(ROW) * u64::from(y);
            let layout = wgpu::TexelCopyBufferLayout { offset, bytes_per_row: Some(4 * ROW), rows_per_image: None };
            let mut texture = self.texture.as_image_copy();
            texture.origin.y = y;
            let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
            encoder.copy_buffer_to_texture(wgpu::TexelCopyBufferInfo { buffer, layout }, texture, size);
        };
        copy(0, ROW, rows);
        copy(rows, rest, 1);
    }
}
