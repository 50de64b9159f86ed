//! Writing of PNG pictures.

use std::io::{self, Write};

use ::image::{ExtendedColorType, ImageEncoder, ImageError, codecs::png::PngEncoder};

use super::Picture;
use crate::image::{Luma, Plane, Size};

/// Writes an 8-bit RGB PNG.
///
/// # Errors
/// The errors of `out`.
pub fn write_rgb8(out: &mut impl Write, picture: &Plane<[u8; 3]>) -> io::Result<()> {
    encode(out, picture.data().as_flattened(), picture.size(), ExtendedColorType::Rgb8)
}

/// Writes an 8-bit RGB PNG with alpha.
///
/// # Errors
/// The errors of `out`.
pub fn write_rgba8(out: &mut impl Write, picture: &Picture) -> io::Result<()> {
    encode(out, picture.rgba(), picture.size(), ExtendedColorType::Rgba8)
}

/// Writes an 8-bit grey PNG.
///
/// # Errors
/// The errors of `out`.
pub fn write_grey8(out: &mut impl Write, picture: &Luma) -> io::Result<()> {
    encode(out, picture.data(), picture.size(), ExtendedColorType::L8)
}

/// Writes a 16-bit grey PNG.
///
/// # Errors
/// The errors of `out`.
pub fn write_grey16(out: &mut impl Write, picture: &Plane<u16>) -> io::Result<()> {
    encode(out, bytemuck::cast_slice(picture.data()), picture.size(), ExtendedColorType::L16)
}

fn encode(
    out: &mut impl Write,
    bytes: &[u8],
    Size { width, height }: Size,
    color: ExtendedColorType,
) -> io::Result<()> {
    let mut out = Keeping { out, error: None };
    PngEncoder::new(&mut out).write_image(bytes, width, height, color).map_err(|error| match (out.error, error) {
        (Some(error), _) | (None, ImageError::IoError(error)) => error,
        (None, other) => io::Error::other(other),
    })
}

/// A writer that keeps its last error: the encoder passes on the text, and not the kind.
struct Keeping<W> {
    out: W,
    error: Option<io::Error>,
}

impl<W> Keeping<W> {
    fn keep<T>(&mut self, written: impl FnOnce(&mut W) -> io::Result<T>) -> io::Result<T> {
        written(&mut self.out).map_err(|error| {
            let kind = error.kind();
            self.error = Some(error);
            kind.into()
        })
    }
}

impl<W: Write> Write for Keeping<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.keep(|out| out.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.keep(W::flush)
    }
}
