//! Loading of photographs from PNG, JPEG, PNM, BMP, TIFF and WebP files.
//!
//! Grey and RGB of 8 and 16 bits, with or without alpha, become RGBA of 8 bits:
//! - 16-bit values keep their upper 8 bits (`>> 8`), which restores 8-bit values stored as 16 bits (`257 * v`);
//! - alpha is dropped, not composited: the camera's picture is matched, and a background would add edges of its own;
//! - pictures are rotated by their EXIF orientation, as in viewers;
//! - colour profiles and gamma are ignored: both views have the same.
//!
//! CMYK and floating-point pictures are refused, since their conversion to 8 bits would be a guess. Only the first
//! frame or page of a file is read.

use std::{io::Cursor, path::Path};

use ::image::{ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::{MAX_PIXELS, Picture, check_pixels, jpeg, malformed, read_whole};
use crate::error::{Error, Result};

/// Bytes per pixel of the largest accepted layout, RGBA of 16 bits.
const MAX_BYTES_PER_PIXEL: u64 = 8;

/// Memory that a codec may need besides the pixels and the file, in bytes.
const CODEC_BYTES: u64 = 1 << 22;

/// Loads a picture file as RGBA of 8 bits.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn load(path: &Path) -> Result<Picture> {
    decode(&read_bytes(path)?, path)
}

/// Decodes the picture in a file's bytes to RGBA of 8 bits; `path` is named in errors.
///
/// # Errors
/// [`Error::Format`] if the bytes are no picture of a supported format, are damaged or cut off, or hold more than
/// [`MAX_PIXELS`].
pub fn decode(bytes: &[u8], path: &Path) -> Result<Picture> {
    use DynamicImage as Image;
    let image = decode_image(bytes, path)?;
    let (width, height) = (image.width(), image.height());
    let high = |sample: u16| (sample >> 8) as u8;
    let pixels = match image {
        Image::ImageLuma8(image) => opaque(image.as_raw(), |&[grey]: &[u8; 1]| [grey; 3]),
        Image::ImageLumaA8(image) => opaque(image.as_raw(), |&[grey, _]: &[u8; 2]| [grey; 3]),
        Image::ImageRgb8(image) => opaque(image.as_raw(), |&rgb: &[u8; 3]| rgb),
        Image::ImageRgba8(image) => opaque(image.as_raw(), |&[r, g, b, _]: &[u8; 4]| [r, g, b]),
        Image::ImageLuma16(image) => opaque(image.as_raw(), |&[grey]: &[u16; 1]| [high(grey); 3]),
        Image::ImageLumaA16(image) => opaque(image.as_raw(), |&[grey, _]: &[u16; 2]| [high(grey); 3]),
        Image::ImageRgb16(image) => opaque(image.as_raw(), |&rgb: &[u16; 3]| rgb.map(high)),
        Image::ImageRgba16(image) => opaque(image.as_raw(), |&[r, g, b, _]: &[u16; 4]| [r, g, b].map(high)),
        other => return Err(unsupported(describe(other.color()), path)),
    };
    Picture::new((width, height), pixels)
}

/// Converts pixels of `N` samples to opaque RGBA.
fn opaque<T, const N: usize>(samples: &[T], rgb: impl Fn(&[T; N]) -> [u8; 3]) -> Vec<[u8; 4]> {
    let opaque = |pixel| {
        let [red, green, blue] = rgb(pixel);
        [red, green, blue, 255]
    };
    samples.as_chunks().0.iter().map(opaque).collect()
}

/// Reads the bytes of a picture file, up to the length of the largest uncompressed picture.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    read_whole(path, MAX_PIXELS * MAX_BYTES_PER_PIXEL)
}

/// Decodes a picture in its stored sample format, rotated upright.
pub(super) fn decode_image(bytes: &[u8], path: &Path) -> Result<DynamicImage> {
    let damaged = |error| explain(error, path);
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| malformed(path, format!("not a picture: {error}")))?;
    match reader.format() {
        None => {
            return Err(malformed(
                path,
                "not a picture of a supported format: PNG, JPEG, PNM, BMP, TIFF and WebP are read",
            ));
        }
        Some(ImageFormat::Jpeg) => {
            if let Some(objection) = jpeg::objection(bytes) {
                return Err(malformed(path, objection));
            }
        }
        Some(_) => {}
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_PIXELS * MAX_BYTES_PER_PIXEL);
    reader.limits(limits);

    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_pixels((width, height), path)?;
    // Whatever else the header claims, no more memory is needed than for the pixels and the file itself.
    let pixels = u64::from(width) * u64::from(height);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES_PER_PIXEL * pixels + bytes.len() as u64 + CODEC_BYTES);
    decoder.set_limits(limits).map_err(damaged)?;
    let stored = decoder.original_color_type();
    if matches!(stored, ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16) {
        return Err(unsupported("CMYK", path));
    }
    if matches!(stored, ExtendedColorType::Rgb32F | ExtendedColorType::Rgba32F) {
        return Err(unsupported(describe(decoder.color_type()), path));
    }
    // Damaged metadata is no reason to refuse a picture.
    let orientation = decoder.orientation().ok();
    let mut image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    if let Some(orientation) = orientation {
        image.apply_orientation(orientation);
    }
    Ok(image)
}

/// Name of a colour type.
pub(super) fn describe(color: ColorType) -> &'static str {
    match color {
        ColorType::L8 => "8-bit grey",
        ColorType::La8 => "8-bit grey with alpha",
        ColorType::Rgb8 => "8-bit RGB",
        ColorType::Rgba8 => "8-bit RGBA",
        ColorType::L16 => "16-bit grey",
        ColorType::La16 => "16-bit grey with alpha",
        ColorType::Rgb16 => "16-bit RGB",
        ColorType::Rgba16 => "16-bit RGBA",
        _ => "floating-point values",
    }
}

fn unsupported(what: &str, path: &Path) -> Error {
    malformed(path, format!("a picture of {what}: convert it to grey or RGB of 8 or 16 bits, for example a PNG"))
}

fn explain(error: ImageError, path: &Path) -> Error {
    malformed(
        path,
        match error {
            ImageError::IoError(_) => "the picture is cut off: copy or export it again".into(),
            ImageError::Limits(_) => {
                format!("the picture needs more memory than {MAX_PIXELS} pixels do: scale it down")
            }
            ImageError::Unsupported(what) => format!("{what}: convert the picture to PNG"),
            damage => format!("the picture is damaged ({damage}): copy or export it again"),
        },
    )
}
