//! Packed luma: one byte per pixel, four pixels per `u32`.

use crate::{
    error::{Result, check},
    gpu::{Gpu, check_buffer, storage_buffer},
    image::{Luma, Size},
};

/// Bytes of a packed picture.
pub fn packed_bytes(size: impl Into<Size>) -> u64 {
    let Size { width, height } = size.into();
    4 * u64::from(width.div_ceil(4)) * u64::from(height)
}

/// The longest accepted side of a picture, in pixels: more would need more workgroups than a dispatch can have.
pub const MAX_SIDE: u32 = 1 << 19;

/// Checks that both sides are 1 to [`MAX_SIDE`] pixels.
pub(crate) fn check_size(size: Size) -> Result<()> {
    let sides = [size.width, size.height];
    let expected = format!("its sides must be 1 to {MAX_SIDE}");
    check(
        sides.iter().all(|side| (1..=MAX_SIDE).contains(side)),
        "the picture",
        format_args!("{size} pixels"),
        expected,
    )
}

/// Checks the size, and that `luma` is large enough for a packed picture of it and has usage `STORAGE`.
pub(crate) fn check_packed(luma: &wgpu::Buffer, size: Size) -> Result<()> {
    check_size(size)?;
    check_buffer("packed luma", luma, packed_bytes(size), wgpu::BufferUsages::STORAGE)
}

/// Packs a picture: four pixels per `u32`, the first in the lowest byte, each row in words of its own.
pub fn pack(luma: &Luma) -> Vec<u32> {
    let word = |pixels: &[u8]| pixels.iter().rev().fold(0, |word, &pixel| word << 8 | u32::from(pixel));
    (0..luma.height()).flat_map(|y| luma.row(y).chunks(4).map(word)).collect()
}

/// Uploads a packed picture to a buffer of its own.
///
/// # Errors
/// [`crate::Error::TooLarge`] if the device cannot bind the buffer, [`crate::Error::OutOfMemory`].
pub(crate) async fn upload(gpu: &Gpu, luma: &Luma) -> Result<wgpu::Buffer> {
    let Size { width, height } = luma.size();
    let allocate = || storage_buffer(gpu, "luma", packed_bytes((width, height)));
    let buffer = gpu.with_room("the picture", allocate).await?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&pack(luma)));
    Ok(buffer)
}

/// Unpacks a picture from `words` as [`pack`] packs it.
///
/// # Panics
/// If a side is 0 or `words` has too few elements.
pub fn unpack(size: impl Into<Size>, words: &[u32]) -> Luma {
    let size = size.into();
    let stride = size.width.div_ceil(4) as usize;
    Luma::from_fn(size, |x, y| words[y as usize * stride + x as usize / 4].to_le_bytes()[x as usize % 4])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_fill_words_from_the_lowest_byte_and_rows_start_new_ones() {
        let luma = Luma::new((5, 2), vec![1, 2, 3, 4, 5, 6, 7, 8, 9, 10]).unwrap();
        assert_eq!(pack(&luma), [0x0403_0201, 0x05, 0x0908_0706, 0x0a]);
        assert_eq!(packed_bytes((5, 2)), 16);
        assert_eq!(unpack((5, 2), &pack(&luma)), luma);
    }
}
