//! Decoding of picture files to the samples that they store.

use std::{io::Cursor, path::Path};

use ::image::{
    ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageFormat, ImageReader, Limits, metadata::Orientation,
};

use super::{
    MAX_PIXELS, check_pixels, claims,
    decoded::{Decoded, MAX_BYTES_PER_PIXEL, explain, float_image, most_bytes, unsupported},
    jpeg, malformed, pfm, png_chunks, read_if, tiff,
};
use crate::{
    error::{Result, shown},
    memory,
};

/// Bytes per pixel of a picture that becomes RGBA of 8 bits, besides its samples, and of what codecs keep of it.
const PREPARED_BYTES_PER_PIXEL: u64 = 8;

/// First bytes of a BigTIFF, little and big endian, which the `image` crate decodes but does not recognise.
const BIG_TIFF: [&[u8]; 2] = [b"II+\0", b"MM\0+"];

/// The formats that are read, but for PFM.
const READ: [ImageFormat; 6] =
    [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Pnm, ImageFormat::Bmp, ImageFormat::Tiff, ImageFormat::WebP];

/// Reads the bytes of a picture file, up to the length of the largest uncompressed picture; of any other file the first few.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    read_if(path, MAX_PIXELS * MAX_BYTES_PER_PIXEL, is_picture)
}

/// Whether a file that begins so may be a picture: devices and other files without an end are not read.
fn is_picture(head: &[u8]) -> bool {
    let heads: [&[u8]; 9] =
        [b"\x89PNG", b"\xff\xd8", b"P", b"BM", b"II*\0", b"MM\0*", BIG_TIFF[0], BIG_TIFF[1], b"RIFF"];
    heads.iter().any(|known| head.starts_with(known))
}

/// Decodes a picture in its stored sample format, rotated upright. Grey of 32 and more bits becomes RGB of 32-bit
/// floats, for which [`DynamicImage`] has a layout.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<Decoded> {
    if bytes.starts_with(b"Pf") || bytes.starts_with(b"PF") {
        let grey = pfm::decode(bytes, path)?;
        let image = float_image(grey.size(), 1, grey.into_data());
        return Ok(Decoded::upright(image));
    }
    if let Some(format) = heif(bytes) {
        let reason = format!(
            "a picture of the format {format}, which is not read: convert it to PNG or JPEG, for example by heif-convert photo.heic photo.png \
             or by ImageMagick (magick photo.heic photo.png), or have the camera write JPEG"
        );
        return Err(malformed(path, reason));
    }
    let damaged = |error| explain(error, path);
    let format = match ::image::guess_format(bytes) {
        _ if BIG_TIFF.iter().any(|magic| bytes.starts_with(magic)) => ImageFormat::Tiff,
        Ok(format) if READ.contains(&format) => format,
        Ok(other) => {
            return Err(malformed(
                path,
                format!("a picture of the format {other:?}, which is not read: convert the picture to PNG"),
            ));
        }
        Err(_) => {
            return Err(malformed(
                path,
                "not a picture of a supported format: PNG, JPEG, PNM, BMP, TIFF and WebP are read, and PFM",
            ));
        }
    };
    let claimed = claims::size(bytes).map_err(|reason| malformed(path, reason))?;
    if let Some(size) = claimed {
        check_pixels(size, path)?;
    }
    let (bytes, doubt) = match format {
        ImageFormat::Jpeg => jpeg::whole(bytes).map_err(|reason| malformed(path, reason))?,
        ImageFormat::Png => png_chunks::essential(bytes),
        ImageFormat::Tiff => match tiff::decode_wide(bytes, path)? {
            Some(decoded) => return Ok(decoded),
            None => (bytes.into(), None),
        },
        _ => (bytes.into(), None),
    };
    let bytes = &*bytes;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // What is expanded before the size is asked for is limited, too.
    let mut limits = Limits::default();
    limits.max_alloc = Some(claimed.map_or(MAX_PIXELS * MAX_BYTES_PER_PIXEL, |size| most_bytes(size, bytes)));
    reader.limits(limits);

    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_pixels((width, height), path)?;
    let needed = decoder.total_bytes() + PREPARED_BYTES_PER_PIXEL * u64::from(width) * u64::from(height);
    let what = || format!("reading {} ({width}x{height} pixels)", shown(path));
    memory::check(needed, memory::Left::now(), what, "scale the picture down, or raise the limit")?;
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
    Ok(Decoded { image, orientation, doubt })
}

/// The name of the format of a file that begins as those of phones do: a box 'ftyp' with its brand (ISO/IEC 14496-12 and 23008-12).
fn heif(head: &[u8]) -> Option<&'static str> {
    let brand = head.get(4..12)?.strip_prefix(b"ftyp")?;
    match brand {
        b"avif" | b"avis" => Some("AVIF"),
        b"heic" | b"heix" | b"heim" | b"heis" | b"hevc" | b"hevx" => Some("HEIC"),
        b"mif1" | b"msf1" => Some("HEIF"),
        _ => None,
    }
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
