//! A device on which single kernels run: buffers on their way there and back.

use crate::{
    error::Result,
    gpu::{Gpu, Readback, WordTexture, guarded, in_rows, storage_buffer, wait},
    image::Luma,
    luma::pack,
};

/// A device that kernels are tried on.
#[derive(Clone, Copy)]
pub struct Bench<'g> {
    /// The device.
    pub gpu: &'g Gpu,
}

impl<'g> Bench<'g> {
    /// On an open device.
    pub fn new(gpu: &'g Gpu) -> Self {
        Self { gpu }
    }

    /// The device.
    pub fn device(&self) -> &'g wgpu::Device {
        &self.gpu.device
    }

    /// A storage buffer that holds `values`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload<T: bytemuck::NoUninit>(&self, values: &[T]) -> Result<wgpu::Buffer> {
        let buffer = storage_buffer(self.device(), "input", size_of_val(values) as u64)?;
        self.write(&buffer, values);
        Ok(buffer)
    }

    /// A texture that holds `values`, words one after the other.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload_words<T: bytemuck::NoUninit>(&self, values: &[T]) -> Result<WordTexture> {
        let words = (size_of_val(values) as u64).div_ceil(4);
        let texture = WordTexture::new(self.device(), "input", words)?;
        let buffer = storage_buffer(self.device(), "input", 4 * in_rows(words))?;
        self.write(&buffer, values);
        self.run(|encoder| texture.record(encoder, &buffer));
        Ok(texture)
    }

    /// A picture, packed, in a storage buffer.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn upload_luma(&self, luma: &Luma) -> Result<wgpu::Buffer> {
        self.upload(&pack(luma))
    }

    /// A storage buffer of so many words, full of ones.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`].
    pub fn output(&self, words: u32) -> Result<wgpu::Buffer> {
        let buffer = storage_buffer(self.device(), "output", 4 * u64::from(words))?;
        self.poison(&buffer);
        Ok(buffer)
    }

    /// Overwrites the first values of `buffer`, a whole number of words.
    pub fn write<T: bytemuck::NoUninit>(&self, buffer: &wgpu::Buffer, values: &[T]) {
        self.gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
    }

    /// Fills `buffer` with ones, so that 'wrote 0' differs from 'never wrote'.
    pub fn poison(&self, buffer: &wgpu::Buffer) {
        self.write(buffer, &vec![0xff_u8; buffer.size() as usize]);
    }

    /// Submits what `record` records.
    pub fn run(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let mut encoder = self.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// All of `buffer`, after everything that was submitted.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`].
    pub fn download<T: bytemuck::Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>> {
        let readback = Readback::new(self.device(), "result", buffer.size());
        self.run(|encoder| readback.record(encoder, buffer));
        wait(self.device(), readback.read(buffer.size() as usize / size_of::<T>()))
    }

    /// What `work` returns, or what the device has to say against it.
    ///
    /// # Errors
    /// Those of `work`; [`crate::Error::Unsupported`], [`crate::Error::OutOfMemory`].
    pub fn guarded<T>(&self, what: &str, work: impl FnOnce() -> Result<T>) -> Result<T> {
        wait(self.device(), guarded(self.device(), what, work))
    }
}
