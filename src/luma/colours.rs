//! A picture in colour on a device.

use crate::{
    error::Result,
    gpu::{Gpu, storage_buffer},
    image::Size,
    io::Picture,
};

/// RGBA8 on a device, one `u32` per pixel with red in its lowest byte: in bands of rows, since colours take four times
/// the memory of luma and can exceed what a kernel can bind.
#[derive(Clone, Debug)]
pub(crate) struct Colours {
    size: Size,
    /// Rows of each band but the last.
    rows: u32,
    bands: Vec<wgpu::Buffer>,
}

impl Colours {
    /// Allocates the memory for a picture of `size`.
    ///
    /// # Errors
    /// [`crate::Error::TooLarge`] if the device cannot bind a row.
    pub fn new(gpu: &Gpu, size: Size) -> Result<Self> {
        let row_bytes = 4 * u64::from(size.width);
        let fitting = gpu.device.limits().max_storage_buffer_binding_size / row_bytes;
        let rows = fitting.clamp(1, size.height.into()) as u32;
        let band = |first_row: u32| {
            storage_buffer(gpu, "rows of the picture", row_bytes * u64::from(rows.min(size.height - first_row)))
        };
        let bands = (0..size.height).step_by(rows as usize).map(band).collect::<Result<_>>()?;
        Ok(Self { size, rows, bands })
    }

    /// Uploads a picture of this size.
    pub fn write(&self, gpu: &Gpu, picture: &Picture) {
        let mut rest = picture.rgba();
        for (_, size, buffer) in self.bands() {
            let pixels;
            (pixels, rest) = rest.split_at(4 * size.pixels() as usize);
            gpu.queue.write_buffer(buffer, 0, pixels);
        }
    }

    /// First row, size and buffer of each band.
    pub fn bands(&self) -> impl Iterator<Item = (u32, Size, &wgpu::Buffer)> {
        let Size { width, height } = self.size;
        let first_rows = (0..height).step_by(self.rows as usize);
        let band = move |first_row: u32| Size::new(width, self.rows.min(height - first_row));
        first_rows.zip(&self.bands).map(move |(first_row, buffer)| (first_row, band(first_row), buffer))
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.bands.iter().map(wgpu::Buffer::size).sum()
    }
}
