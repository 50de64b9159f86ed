//! A decoded picture file, its limits in memory, and the errors of codecs.

use std::path::Path;

use ::image::{DynamicImage, ImageError, Rgb32FImage, Rgba32FImage, metadata::Orientation};

use super::{MAX_PIXELS, malformed};
use crate::{error::Error, image::Size};

/// Bytes per pixel of the largest accepted layout, RGBA of 32 bits.
pub(super) const MAX_BYTES_PER_PIXEL: u64 = 16;

/// Memory that a codec may need besides the pixels and the file, in bytes.
const CODEC_BYTES: u64 = 1 << 22;

/// A decoded file: its samples, rotated upright, and the rotation.
pub(super) struct Decoded {
    pub image: DynamicImage,
    pub orientation: Orientation,
    /// What is odd about the file, though all of its picture is there.
    pub doubt: Option<String>,
}

impl Decoded {
    /// A picture as it was taken, of a file without oddities.
    pub fn upright(image: DynamicImage) -> Self {
        Self { image, orientation: Orientation::NoTransforms, doubt: None }
    }
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

/// The error of a file whose samples are of a kind that is not read.
pub(super) fn unsupported(what: &str, path: &Path) -> Error {
    malformed(path, format!("a picture of {what}: convert it to grey or RGB of 8 or 16 bits, for example a PNG"))
}

/// The error of a codec, with the way out.
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
