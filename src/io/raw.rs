//! Pictures in memory, in samples of 8 bits, 16 bits or floats: what a camera or another library hands over.

use std::path::Path;

use ::image::{DynamicImage, GrayAlphaImage, GrayImage, ImageBuffer, RgbImage, RgbaImage};

use super::{
    MAX_PIXELS, check_pixels,
    decoded::{Decoded, float_image},
};
use crate::{
    error::{Result, check},
    image::Size,
};

/// The samples of a picture, pixel by pixel and row by row.
#[derive(Clone, Debug, PartialEq)]
pub enum RawSamples {
    /// Integers of 8 bits.
    Eight(Vec<u8>),
    /// Integers of 16 bits.
    Sixteen(Vec<u16>),
    /// Floats; a pixel with a sample that is not finite was not seen.
    Float(Vec<f32>),
}

impl RawSamples {
    fn len(&self) -> usize {
        match self {
            Self::Eight(samples) => samples.len(),
            Self::Sixteen(samples) => samples.len(),
            Self::Float(samples) => samples.len(),
        }
    }
}

/// A picture in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct RawPicture {
    image: DynamicImage,
}

impl RawPicture {
    /// A picture of 1 (grey), 2 (grey and alpha), 3 (red, green, blue) or 4 (and alpha) samples per pixel. Alpha 0 stands for a pixel
    /// that was not seen.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for another number of channels, or of samples than the size needs;
    /// [`crate::Error::Format`] for no pixels or more than [`MAX_PIXELS`].
    pub fn new(size: impl Into<Size>, channels: usize, samples: RawSamples) -> Result<Self> {
        let size = size.into();
        check((1..=4).contains(&channels), "the number of channels", channels, "it must be 1 to 4")?;
        check_pixels(size, Path::new("the picture"))?;
        debug_assert!(size.pixels() <= MAX_PIXELS);
        let needed = size.pixels() as usize * channels;
        check(
            samples.len() == needed,
            "the picture",
            format_args!("{} samples", samples.len()),
            format!("{size} pixels of {channels} channels need {needed}"),
        )?;
        let image = match samples {
            RawSamples::Eight(samples) => eight(size, channels, samples),
            RawSamples::Sixteen(samples) => sixteen(size, channels, samples),
            RawSamples::Float(samples) => Some(float_image(size, channels, samples)),
        };
        Ok(Self { image: image.expect("as many samples as the size needs") })
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> Size {
        Size::new(self.image.width(), self.image.height())
    }

    pub(super) fn into_decoded(self) -> Decoded {
        Decoded::upright(self.image)
    }
}

fn eight(Size { width, height }: Size, channels: usize, samples: Vec<u8>) -> Option<DynamicImage> {
    Some(match channels {
        1 => GrayImage::from_raw(width, height, samples)?.into(),
        2 => GrayAlphaImage::from_raw(width, height, samples)?.into(),
        3 => RgbImage::from_raw(width, height, samples)?.into(),
        _ => RgbaImage::from_raw(width, height, samples)?.into(),
    })
}

fn sixteen(Size { width, height }: Size, channels: usize, samples: Vec<u16>) -> Option<DynamicImage> {
    Some(match channels {
        1 => DynamicImage::ImageLuma16(ImageBuffer::from_raw(width, height, samples)?),
        2 => DynamicImage::ImageLumaA16(ImageBuffer::from_raw(width, height, samples)?),
        3 => DynamicImage::ImageRgb16(ImageBuffer::from_raw(width, height, samples)?),
        _ => DynamicImage::ImageRgba16(ImageBuffer::from_raw(width, height, samples)?),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::load::{LoadedPair, Stretch, picture_of};

    #[test]
    fn pictures_of_every_kind_by_hand() {
        let eight = |channels, samples| RawPicture::new((2, 1), channels, RawSamples::Eight(samples)).unwrap();
        let pixels = |raw| picture_of(raw).unwrap().into_data();
        assert_eq!(pixels(eight(1, vec![7, 9])), [[7, 7, 7, 255], [9, 9, 9, 255]]);
        assert_eq!(pixels(eight(2, vec![7, 0, 9, 1])), [[7, 7, 7, 0], [9, 9, 9, 255]]);
        assert_eq!(pixels(eight(3, vec![1, 2, 3, 4, 5, 6])), [[1, 2, 3, 255], [4, 5, 6, 255]]);
        assert_eq!(pixels(eight(4, vec![1, 2, 3, 0, 4, 5, 6, 9])), [[1, 2, 3, 0], [4, 5, 6, 255]]);
        let sixteen = RawPicture::new((2, 1), 1, RawSamples::Sixteen(vec![257 * 3, 257 * 200])).unwrap();
        assert_eq!(pixels(sixteen), [[3, 3, 3, 255], [200, 200, 200, 255]]);
        let float = RawPicture::new((3, 1), 1, RawSamples::Float(vec![0.0, f32::NAN, 1.0])).unwrap();
        assert_eq!(pixels(float), [[0, 0, 0, 255], [0, 0, 0, 0], [255; 4]]);
    }

    /// One stretch for both views, so that equal samples stay equal.
    #[test]
    fn a_pair_has_one_stretch() {
        let float = |samples| RawPicture::new((2, 1), 1, RawSamples::Float(samples)).unwrap();
        let pair = LoadedPair::from_raw(float(vec![0.0, 0.5]), float(vec![0.5, 1.0])).unwrap();
        assert_eq!(pair.stretch, Some(Stretch { low: 0.0, high: 1.0 }));
        assert_eq!(pair.left.get(1, 0), pair.right.get(0, 0));
        let eight = RawPicture::new((2, 1), 1, RawSamples::Eight(vec![1, 2])).unwrap();
        let error = LoadedPair::from_raw(float(vec![0.0, 0.5]), eight).unwrap_err().to_string();
        assert!(error.starts_with("the left view: the picture has floating-point samples"), "{error}");
    }

    #[test]
    fn what_is_no_picture_is_named() {
        let error = |size, channels, count| {
            RawPicture::new(size, channels, RawSamples::Eight(vec![1; count])).unwrap_err().to_string()
        };
        assert_eq!(error((2, 2), 3, 11), "the picture is 11 samples, but 2x2 pixels of 3 channels need 12");
        assert_eq!(error((2, 2), 5, 20), "the number of channels is 5, but it must be 1 to 4");
        assert_eq!(error((0, 2), 1, 0), "the picture: its size is 0x2: there is nothing in it");
        let unseen = RawPicture::new((1, 1), 1, RawSamples::Float(vec![f32::NAN])).unwrap();
        assert!(picture_of(unseen).unwrap_err().to_string().contains("no pixel is a finite number"));
    }
}
