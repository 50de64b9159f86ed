//! PNG files, written whole or not at all.

use std::{fs::File, io, io::BufWriter, path::Path};

use ::image::{ExtendedColorType, ImageEncoder, ImageError, codecs::png::PngEncoder};

use super::atomic::write_whole;
use crate::{
    error::Result,
    image::{Luma, Plane},
};

/// Writes colours of 8 bits.
///
/// # Errors
/// As [`write_whole`].
pub fn write_rgb8(path: &Path, picture: &Plane<[u8; 3]>) -> Result<()> {
    let bytes = picture.data().as_flattened();
    write_whole(path, |out| encode(out, bytes, picture.size(), ExtendedColorType::Rgb8))
}

/// Writes grey values of 8 bits.
///
/// # Errors
/// As [`write_whole`].
pub fn write_grey8(path: &Path, picture: &Luma) -> Result<()> {
    write_whole(path, |out| encode(out, picture.data(), picture.size(), ExtendedColorType::L8))
}

/// Writes grey values of 16 bits.
///
/// # Errors
/// As [`write_whole`].
pub fn write_grey16(path: &Path, picture: &Plane<u16>) -> Result<()> {
    let bytes = bytemuck::cast_slice(picture.data());
    write_whole(path, |out| encode(out, bytes, picture.size(), ExtendedColorType::L16))
}

fn encode(
    out: &mut BufWriter<&File>,
    bytes: &[u8],
    (width, height): (u32, u32),
    color: ExtendedColorType,
) -> io::Result<()> {
    PngEncoder::new(out).write_image(bytes, width, height, color).map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })
}
