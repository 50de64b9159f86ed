//! TIFF of samples that the `image` crate refuses: grey floats, signed integers, and more than 32 bits.
//!
//! Remote sensing has many of them: reflectances in floats, elevations in signed 16 bits.

use std::{io::Cursor, path::Path};

use ::image::metadata::Orientation;
use ::tiff::{
    ColorType, TiffError,
    decoder::{Decoder, DecodingResult, DecodingSampleType, Limits},
    tags::Tag,
};

use super::{
    MAX_PIXELS, check_pixels,
    decoded::{Decoded, float_image, most_bytes},
    malformed,
};
use crate::error::{Error, Result};

/// Decodes a TIFF of floats, signed integers or integers of more than 16 bits to 32-bit floats, rotated upright; `None`
/// for any other TIFF, and for one whose header cannot be read.
///
/// Integers beyond 2^24 and floats of 64 bits are rounded to the nearest float.
pub(super) fn decode_wide(bytes: &[u8], path: &Path) -> Result<Option<Decoded>> {
    let Some((mut decoder, channels)) = wide_decoder(bytes) else { return Ok(None) };
    let refused = |error| explain(error, path);
    let (width, height) = decoder.dimensions().map_err(refused)?;
    check_pixels((width, height), path)?;
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(most_bytes((width, height), bytes)).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.decoding_buffer_size;
    let mut decoder = decoder.with_limits(limits);
    let orientation = orientation(&mut decoder);

    let mut samples = DecodingResult::F32(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut samples).map_err(refused)?;
    let samples = floats(samples);
    let pixels = width as usize * height as usize;
    if samples.len() != pixels * channels {
        return Err(malformed(path, format!("the TIFF has {} samples of {}", samples.len(), pixels * channels)));
    }
    let samples = if layout.planes > 1 { interleaved(&samples, pixels) } else { samples };
    let mut image = float_image((width, height), channels, samples);
    image.apply_orientation(orientation);
    Ok(Some(Decoded { image, orientation, doubt: None }))
}

/// A decoder of `bytes` and the number of channels, if the samples are of a kind that the `image` crate refuses.
fn wide_decoder(bytes: &[u8]) -> Option<(Decoder<Cursor<&[u8]>>, usize)> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?;
    let (channels, bits) = match decoder.colortype().ok()? {
        ColorType::Gray(bits) => (1, bits),
        ColorType::GrayA(bits) => (2, bits),
        ColorType::RGB(bits) => (3, bits),
        ColorType::RGBA(bits) => (4, bits),
        _ => return None,
    };
    let is_wide = match decoder.image_buffer_layout().ok()?.sample_type? {
        DecodingSampleType::U8 | DecodingSampleType::U16 => false,
        _ => matches!(bits, 8 | 16 | 32 | 64),
    };
    is_wide.then_some((decoder, channels))
}

/// The orientation tag; none, or a damaged one, is no reason to refuse a picture.
fn orientation(decoder: &mut Decoder<Cursor<&[u8]>>) -> Orientation {
    let tag = decoder.find_tag_unsigned::<u8>(Tag::Orientation).ok().flatten();
    tag.and_then(Orientation::from_exif).unwrap_or(Orientation::NoTransforms)
}

fn floats(samples: DecodingResult) -> Vec<f32> {
    use DecodingResult as Samples;
    match samples {
        Samples::F16(samples) => samples.into_iter().map(f32::from).collect(),
        Samples::F32(samples) => samples,
        Samples::F64(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        Samples::U8(samples) => samples.into_iter().map(f32::from).collect(),
        Samples::U16(samples) => samples.into_iter().map(f32::from).collect(),
        Samples::U32(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        Samples::U64(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        Samples::I8(samples) => samples.into_iter().map(f32::from).collect(),
        Samples::I16(samples) => samples.into_iter().map(f32::from).collect(),
        Samples::I32(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
        Samples::I64(samples) => samples.into_iter().map(|sample| sample as f32).collect(),
    }
}

/// Pixel after pixel, from plane after plane of `pixels` samples.
fn interleaved(planes: &[f32], pixels: usize) -> Vec<f32> {
    (0..pixels).flat_map(|pixel| planes[pixel..].iter().step_by(pixels).copied()).collect()
}

fn explain(error: TiffError, path: &Path) -> Error {
    malformed(
        path,
        match error {
            TiffError::IoError(_) => "the picture is cut off: copy or export it again".into(),
            TiffError::LimitsExceeded => {
                format!("the picture needs more memory than {MAX_PIXELS} pixels do: scale it down")
            }
            TiffError::UnsupportedError(what) => format!("{what}: convert the picture to PNG"),
            damage => format!("the picture is damaged ({damage}): copy or export it again"),
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::tiff::encoder::{TiffEncoder, colortype};

    fn decoded(bytes: &[u8]) -> Vec<f32> {
        let decoded = decode_wide(bytes, Path::new("a.tif")).unwrap().expect("a kind that is decoded here");
        decoded.image.into_rgb32f().into_raw()
    }

    macro_rules! written {
        ($color:ty, $samples:expr) => {{
            let mut bytes = Cursor::new(Vec::new());
            TiffEncoder::new(&mut bytes).unwrap().write_image::<$color>(2, 1, $samples).unwrap();
            bytes.into_inner()
        }};
    }

    #[test]
    fn grey_of_every_wide_kind() {
        assert_eq!(
            decoded(&written!(colortype::Gray32Float, &[0.25, -9999.0])),
            [0.25, 0.25, 0.25, -9999.0, -9999.0, -9999.0]
        );
        assert_eq!(
            decoded(&written!(colortype::Gray64Float, &[0.25, 1e99])),
            [0.25, 0.25, 0.25, f32::INFINITY, f32::INFINITY, f32::INFINITY]
        );
        assert_eq!(decoded(&written!(colortype::GrayI16, &[-32768, 7])), [-32768.0, -32768.0, -32768.0, 7.0, 7.0, 7.0]);
        assert_eq!(decoded(&written!(colortype::GrayI32, &[-70000, 7])), [-70000.0, -70000.0, -70000.0, 7.0, 7.0, 7.0]);
        assert_eq!(decoded(&written!(colortype::Gray32, &[70000, 7])), [70000.0, 70000.0, 70000.0, 7.0, 7.0, 7.0]);
        assert_eq!(
            decoded(&written!(colortype::RGB32Float, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        );
    }

    #[test]
    fn kinds_of_8_and_16_bits_are_left_to_others() {
        for bytes in [written!(colortype::Gray8, &[1, 2]), written!(colortype::Gray16, &[1, 2]), b"II*\0".to_vec()] {
            assert!(decode_wide(&bytes, Path::new("a.tif")).unwrap().is_none());
        }
    }

    #[test]
    fn every_cut_is_an_error_or_left_to_others() {
        let bytes = written!(colortype::Gray32Float, &[0.25, 1.0]);
        for length in 0..bytes.len() {
            if let Ok(Some(_)) = decode_wide(&bytes[..length], Path::new("a.tif")) {
                panic!("{length} bytes of {} were enough", bytes.len());
            }
        }
    }

    #[test]
    fn planes_are_interleaved_by_hand() {
        assert_eq!(interleaved(&[1.0, 2.0, 10.0, 20.0, 100.0, 200.0], 2), [1.0, 10.0, 100.0, 2.0, 20.0, 200.0]);
    }
}
