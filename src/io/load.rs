//! Photographs from PNG, JPEG, PNM, BMP, TIFF and WebP files.
//!
//! Grey and RGB of 8 and 16 bits, with or without alpha, become RGBA of 8 bits:
//! - of 16 bits the upper 8 are kept (`>> 8`), so that 8 bits stored as 16 (`257 * v`) come back;
//! - alpha is dropped, not composited: what is matched is what the camera saw, and a background
//!   would add edges of its own;
//! - a picture is turned as its EXIF orientation says, as viewers do;
//! - colour profiles and gamma are left alone: both views have the same.
//!
//! CMYK and floats are refused, since their 8-bit values would be a guess. Of several frames or
//! pages the first is read.

use std::{io::Cursor, path::Path};

use ::image::{ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::{MAX_PIXELS, Picture, check_pixels, jpeg, malformed, read_whole};
use crate::error::{Error, Result};

/// The largest sample layout that is accepted, RGBA of 16 bits.
const MAX_BYTES_PER_PIXEL: u64 = 8;

/// What a codec may need beside the pixels and the file.
const CODEC_BYTES: u64 = 1 << 22;

/// Loads a picture.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, otherwise as [`decode`].
pub fn load(path: &Path) -> Result<Picture> {
    decode(&read_bytes(path)?, path)
}

/// The picture in a file's bytes; `path` is named in errors.
///
/// # Errors
/// [`Error::Format`] if they are no picture of a known kind, are damaged or cut off, or hold more
/// than [`MAX_PIXELS`].
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
    Picture::new(width, height, pixels)
}

/// Pixels of `N` samples as RGBA without transparency.
fn opaque<T, const N: usize>(samples: &[T], rgb: impl Fn(&[T; N]) -> [u8; 3]) -> Vec<[u8; 4]> {
    let opaque = |pixel| {
        let [red, green, blue] = rgb(pixel);
        [red, green, blue, 255]
    };
    samples.as_chunks().0.iter().map(opaque).collect()
}

/// The bytes of a picture's file; the longest that is accepted has no compression at all.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    read_whole(path, MAX_PIXELS * MAX_BYTES_PER_PIXEL)
}

/// The picture as it is stored, turned upright.
pub(super) fn decode_image(bytes: &[u8], path: &Path) -> Result<DynamicImage> {
    let damaged = |error| explain(error, path);
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| malformed(path, format!("not a picture: {error}")))?;
    match reader.format() {
        None => {
            return Err(malformed(path, "not a picture that is known here: PNG, JPEG, PNM, BMP, TIFF and WebP are"));
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
    check_pixels(width, height, path)?;
    // Other claims of the header need no more than the pixels and the file itself do.
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

/// A colour type in words.
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
