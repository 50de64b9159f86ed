//! Packed luma: one byte per pixel, four pixels per `u32`.

use crate::{
    error::{Result, check},
    gpu::{Gpu, check_buffer, guarded, storage_buffer},
    image::{Luma, Size},
};

/// Bytes of a packed picture.
pub fn packed_bytes(size: impl Into<Size>) -> u64 {
    let Size { width, height } = size.into();
    4 * u64::from(width.div_ceil(4)) * u64::from(height)
}

/// The longest side of a picture, in pixels: for more there are not enough workgroups in a dispatch.
pub const MAX_SIDE: u32 = 1 << 19;

/// Refuses sizes that no kernel could work on.
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

/// Refuses sizes that no kernel could work on, and a buffer that does not hold a picture of the size, or that no kernel
/// may read.
pub(crate) fn check_packed(luma: &wgpu::Buffer, size: Size) -> Result<()> {
    check_size(size)?;
    check_buffer("packed luma", luma, packed_bytes(size), wgpu::BufferUsages::STORAGE)
}

/// Packs a picture as the kernels read it.
pub fn pack(luma: &Luma) -> Vec<u32> {
    let word = |pixels: &[u8]| pixels.iter().rev().fold(0, |word, &pixel| word << 8 | u32::from(pixel));
    (0..luma.height()).flat_map(|y| luma.row(y).chunks(4).map(word)).collect()
}

/// The picture, packed, in a buffer of its own on the device.
///
/// # Errors
/// [`Error::TooLarge`] where the device cannot bind it, [`Error::OutOfMemory`].
pub(crate) async fn upload(gpu: &Gpu, luma: &Luma) -> Result<wgpu::Buffer> {
    let Size { width, height } = luma.size();
    let allocate = || storage_buffer(gpu, "luma", packed_bytes((width, height)));
    let buffer = guarded(gpu, "the picture", allocate).await?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&pack(luma)));
    Ok(buffer)
}

/// The picture that `words` hold, as [`pack`] packs it.
///
/// # Panics
/// If a side is 0 or there are too few words.
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
