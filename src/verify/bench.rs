//! A bench for single kernels on a device: uploads, dispatches and downloads.

use crate::{
    error::Result,
    gpu::{Gpu, Readback, WordTexture, block_on, guarded, storage_buffer},
    image::{Luma, Size},
    luma::pack,
};

/// A device that kernels are verified on.
#[derive(Clone, Copy, Debug)]
pub struct Bench<'g> {
    /// The device.
    pub gpu: &'g Gpu,
}

impl<'g> Bench<'g> {
    /// Creates a bench on an open device.
    pub fn new(gpu: &'g Gpu) -> Self {
        Self { gpu }
    }

    /// Uploads `values` to a storage buffer.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload<T: bytemuck::NoUninit>(&self, values: &[T]) -> Result<wgpu::Buffer> {
        let buffer = storage_buffer(self.gpu, "input", size_of_val(values) as u64)?;
        self.write(&buffer, values);
        Ok(buffer)
    }

    /// Uploads `values`, whole words, to a texture.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload_words<T: bytemuck::NoUninit>(&self, values: &[T]) -> Result<WordTexture> {
        let words = (size_of_val(values) as u64).div_ceil(4);
        let texture = WordTexture::new(self.gpu, "input", words)?;
        let buffer = storage_buffer(self.gpu, "input", 4 * words)?;
        self.write(&buffer, values);
        self.run(|encoder| texture.record(encoder, &buffer));
        Ok(texture)
    }

    /// Uploads a packed picture to a storage buffer.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload_luma(&self, luma: &Luma) -> Result<wgpu::Buffer> {
        self.upload(&pack(luma))
    }

    /// Allocates a storage buffer of `words` `u32`s with all bits set.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn output(&self, words: u32) -> Result<wgpu::Buffer> {
        let buffer = storage_buffer(self.gpu, "output", 4 * u64::from(words))?;
        self.poison(&buffer);
        Ok(buffer)
    }

    /// Uploads `texels`, row by row, to a texture, and returns its view.
    pub fn texture(&self, format: wgpu::TextureFormat, size: impl Into<Size>, texels: &[u8]) -> wgpu::TextureView {
        let size = size.into();
        let texture = self.plain_texture(format, size, wgpu::TextureUsages::TEXTURE_BINDING);
        let bytes_per_row = Some(texels.len() as u32 / size.height);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None };
        self.gpu.queue.write_texture(texture.as_image_copy(), texels, layout, texture.size());
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Allocates a texture of four bytes per texel for a kernel to write, with all bits set.
    pub fn output_texture(&self, format: wgpu::TextureFormat, size: impl Into<Size>) -> wgpu::Texture {
        let size = size.into();
        let texture = self.plain_texture(format, size, wgpu::TextureUsages::STORAGE_BINDING);
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size.width), rows_per_image: None };
        let ones = vec![0xff; 4 * size.pixels() as usize];
        self.gpu.queue.write_texture(texture.as_image_copy(), &ones, layout, texture.size());
        texture
    }

    fn plain_texture(
        &self,
        format: wgpu::TextureFormat,
        Size { width, height }: Size,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("a picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: usage | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    /// Waits for the submitted work and downloads the texels of a texture, four bytes each, row by row.
    ///
    /// # Errors
    /// See [`Self::download`].
    pub fn download_texture<T: bytemuck::Pod>(&self, texture: &wgpu::Texture) -> Result<Vec<T>> {
        let (width, height) = (texture.width(), texture.height());
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = storage_buffer(self.gpu, "texels", u64::from(row) * u64::from(height))?;
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        self.run(|encoder| {
            let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        });
        let texels = self.download::<T>(&buffer)?;
        Ok(texels.chunks(row as usize / 4).flat_map(|row| &row[..width as usize]).copied().collect())
    }

    /// Overwrites the beginning of `buffer` with `values`, whole words.
    pub fn write<T: bytemuck::NoUninit>(&self, buffer: &wgpu::Buffer, values: &[T]) {
        self.gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
    }

    /// Sets all bits of `buffer`, so that 'wrote 0' differs from 'never wrote'.
    pub fn poison(&self, buffer: &wgpu::Buffer) {
        self.write(buffer, &vec![0xff_u8; buffer.size() as usize]);
    }

    /// Submits the commands that `record` encodes.
    pub fn run(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self.gpu.encoder("trial");
        record(&mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Waits for the submitted work and downloads all of `buffer`.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn download<T: bytemuck::Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
        let readback = Readback::new(self.gpu, "result", buffer.size());
        self.run(|encoder| readback.record(encoder, buffer));
        block_on(readback.read(buffer.size() as usize / size_of::<T>()))
    }

    /// Returns the result of `work`, or an error that the device reports.
    ///
    /// # Errors
    /// The errors of `work`; [`crate::Error::Unsupported`], [`crate::Error::OutOfMemory`].
    pub fn guarded<T>(&self, what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        block_on(guarded(self.gpu, what, work))
    }
}
