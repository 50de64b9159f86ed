//! Decoding of picture files to the samples that they store.

use std::{io::Cursor, path::Path};

use ::image::{
    ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits,
    Rgb32FImage, Rgba32FImage, metadata::Orientation,
};

use super::{MAX_PIXELS, check_pixels, jpeg, malformed, pfm, read_whole, tiff};
use crate::{
    error::{Error, Result},
    image::Size,
};

/// Bytes per pixel of the largest accepted layout, RGBA of 32 bits.
const MAX_BYTES_PER_PIXEL: u64 = 16;

/// Memory that a codec may need besides the pixels and the file, in bytes.
const CODEC_BYTES: u64 = 1 << 22;

/// First bytes of a BigTIFF, little and big endian, which the `image` crate decodes but does not recognise.
const BIG_TIFF: [&[u8]; 2] = [b"II+\0", b"MM\0+"];

/// A decoded file: its samples, rotated upright, and the rotation.
pub(super) struct Decoded {
    pub image: DynamicImage,
    pub orientation: Orientation,
}

/// Reads the bytes of a picture file, up to the length of the largest uncompressed picture.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    read_whole(path, MAX_PIXELS * MAX_BYTES_PER_PIXEL)
}

/// Decodes a picture in its stored sample format, rotated upright. Grey of 32 and more bits becomes RGB of 32-bit
/// floats, for which [`DynamicImage`] has a layout.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Decoded> {
    if bytes.starts_with(b"Pf") || bytes.starts_with(b"PF") {
        let grey = pfm::decode(bytes, path)?;
        let image = float_image(grey.size(), 1, grey.into_data());
        return Ok(Decoded { image, orientation: Orientation::NoTransforms });
    }
    let damaged = |error| explain(error, path);
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| malformed(path, format!("not a picture: {error}")))?;
    if BIG_TIFF.iter().any(|magic| bytes.starts_with(magic)) {
        reader.set_format(ImageFormat::Tiff);
    }
    match reader.format() {
        None => {
            return Err(malformed(
                path,
                "not a picture of a supported format: PNG, JPEG, PNM, BMP, TIFF and WebP are read, and PFM",
            ));
        }
        Some(ImageFormat::Jpeg) => {
            if let Some(objection) = jpeg::objection(bytes) {
                return Err(malformed(path, objection));
            }
        }
        Some(ImageFormat::Tiff) => {
            if let Some(decoded) = tiff::decode_wide(bytes, path)? {
                return Ok(decoded);
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
    let mut limits = Limits::default();
    limits.max_alloc = Some(most_bytes((width, height), bytes));
    decoder.set_limits(limits).map_err(damaged)?;
    let stored = decoder.original_color_type();
    if matches!(stored, ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16) {
        return Err(unsupported("CMYK", path));
    }
    // Damaged metadata is no reason to refuse a picture.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    image.apply_orientation(orientation);
    Ok(Decoded { image, orientation })
}

/// Memory that decoding may take, in bytes: whatever else the header claims, no more is needed than for the pixels and
/// the file itself.
pub(super) fn most_bytes((width, height): (u32, u32), bytes: &[u8]) -> u64 {
    MAX_BYTES_PER_PIXEL * u64::from(width) * u64::from(height) + bytes.len() as u64 + CODEC_BYTES
}

/// A picture of 32-bit floats from samples of 1 (grey), 2 (grey and alpha), 3 (RGB) or 4 (RGBA) `channels`.
///
/// # Panics
/// For samples of another number than `size` needs, or another number of channels.
pub(super) fn float_image(size: impl Into<Size>, channels: usize, samples: Vec<f32>) -> DynamicImage {
    let Size { width, height } = size.into();
    let samples: Vec<f32> = match channels {
        1 => samples.into_iter().flat_map(|grey| [grey; 3]).collect(),
        2 => samples.as_chunks().0.iter().flat_map(|&[grey, alpha]| [grey, grey, grey, alpha]).collect(),
        _ => samples,
    };
    let image = match channels {
        1 | 3 => Rgb32FImage::from_raw(width, height, samples).map(DynamicImage::ImageRgb32F),
        _ => Rgba32FImage::from_raw(width, height, samples).map(DynamicImage::ImageRgba32F),
    };
    image.expect("one to four samples per pixel")
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

pub(super) fn unsupported(what: &str, path: &Path) -> Error {
    malformed(path, format!("a picture of {what}: convert it to grey or RGB of 8 or 16 bits, for example a PNG"))
}

pub(super) fn explain(error: ImageError, path: &Path) -> Error {
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
