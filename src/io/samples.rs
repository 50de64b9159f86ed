//! Pictures in the samples of their files, before they become 8 bits.

use ::image::{DynamicImage, metadata::Orientation};

use super::{Picture, decoded::Decoded};
use crate::image::Size;

/// The kind of a file's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Integers of 8 bits.
    Eight,
    /// Integers of 16 bits.
    Sixteen,
    /// Floats, and integers that do not fit in 16 bits.
    Float,
}

impl Kind {
    /// The kind of a decoded file.
    pub fn of(decoded: &Decoded) -> Self {
        Self::of_image(&decoded.image)
    }

    fn of_image(image: &DynamicImage) -> Self {
        use DynamicImage as Image;
        match image {
            Image::ImageLuma8(_) | Image::ImageLumaA8(_) | Image::ImageRgb8(_) | Image::ImageRgba8(_) => Self::Eight,
            Image::ImageLuma16(_) | Image::ImageLumaA16(_) | Image::ImageRgb16(_) | Image::ImageRgba16(_) => {
                Self::Sixteen
            }
            _ => Self::Float,
        }
    }

    /// The largest sample of integers, which are whole numbers from 0 on; `None` for floats.
    pub fn largest(self) -> Option<f32> {
        match self {
            Self::Eight => Some(255.0),
            Self::Sixteen => Some(65_535.0),
            Self::Float => None,
        }
    }
}

/// A picture in the samples of its file, and which of its pixels were seen.
pub(super) struct Samples {
    image: DynamicImage,
    /// The orientation that the file names, and that was applied.
    pub orientation: Orientation,
    /// What is odd about the file.
    pub doubt: Option<String>,
    /// One entry per pixel, row by row.
    seen: Vec<bool>,
}

impl Samples {
    /// The samples of a file; unseen are pixels of alpha 0 and those with a sample that is not finite.
    pub fn new(Decoded { image, orientation, doubt }: Decoded) -> Self {
        let mut seen = Vec::with_capacity(image.width() as usize * image.height() as usize);
        for_each(&image, |color, alpha| seen.push(alpha != 0.0 && color.iter().all(|sample| sample.is_finite())));
        Self { image, orientation, doubt, seen }
    }

    pub fn size(&self) -> Size {
        Size::new(self.image.width(), self.image.height())
    }

    pub fn kind(&self) -> Kind {
        Kind::of_image(&self.image)
    }

    /// Whether any pixel was seen.
    pub fn is_seen(&self) -> bool {
        self.seen.contains(&true)
    }

    /// Number of seen pixels.
    pub fn count_seen(&self) -> usize {
        self.seen.iter().filter(|&&seen| seen).count()
    }

    /// Red, green and blue samples of every seen pixel, row by row; grey is three times the same.
    pub fn for_each_seen(&self, mut f: impl FnMut([f32; 3])) {
        let mut seen = self.seen.iter();
        for_each(&self.image, |color, _| {
            if seen.next() == Some(&true) {
                f(color);
            }
        });
    }

    /// Makes pixels unseen whose samples, without alpha, all equal `value`.
    pub fn hide_value(&mut self, value: f32) {
        let mut seen = self.seen.iter_mut();
        for_each(&self.image, |color, _| {
            if let Some(seen) = seen.next() {
                *seen &= color != [value; 3];
            }
        });
    }

    /// Makes pixels unseen where `mask`, of the same size, is 0 or unseen itself.
    pub fn hide_outside(&mut self, mask: &Self) {
        let mut pixels = self.seen.iter_mut().zip(&mask.seen);
        for_each(&mask.image, |color, _| {
            if let Some((seen, mask_seen)) = pixels.next() {
                *seen &= mask_seen & (color != [0.0; 3]);
            }
        });
    }

    /// The picture of 8 bits: each sample by `grey`, alpha 255 where seen, 0 elsewhere.
    pub fn picture(&self, grey: impl Fn(f32) -> u8) -> Picture {
        let mut pixels = Vec::with_capacity(self.seen.len());
        let mut seen = self.seen.iter();
        for_each(&self.image, |color, _| {
            let [red, green, blue] = color.map(&grey);
            pixels.push([red, green, blue, if seen.next() == Some(&true) { 255 } else { 0 }]);
        });
        Picture::new(self.size(), pixels).expect("one entry per pixel")
    }
}

/// Calls `f` with the colour and the alpha of each pixel, row by row. Every 16-bit integer is a float.
fn for_each(image: &DynamicImage, f: impl FnMut([f32; 3], f32)) {
    use DynamicImage as Image;
    match image {
        Image::ImageLuma8(image) => visit(image.as_raw(), |&[grey]: &[u8; 1]| ([grey; 3], 1), f),
        Image::ImageLumaA8(image) => visit(image.as_raw(), |&[grey, alpha]: &[u8; 2]| ([grey; 3], alpha), f),
        Image::ImageRgb8(image) => visit(image.as_raw(), |&color: &[u8; 3]| (color, 1), f),
        Image::ImageRgba8(image) => visit(image.as_raw(), |&[r, g, b, alpha]: &[u8; 4]| ([r, g, b], alpha), f),
        Image::ImageLuma16(image) => visit(image.as_raw(), |&[grey]: &[u16; 1]| ([grey; 3], 1), f),
        Image::ImageLumaA16(image) => visit(image.as_raw(), |&[grey, alpha]: &[u16; 2]| ([grey; 3], alpha), f),
        Image::ImageRgb16(image) => visit(image.as_raw(), |&color: &[u16; 3]| (color, 1), f),
        Image::ImageRgba16(image) => visit(image.as_raw(), |&[r, g, b, alpha]: &[u16; 4]| ([r, g, b], alpha), f),
        Image::ImageRgb32F(image) => visit(image.as_raw(), |&color: &[f32; 3]| (color, 1.0), f),
        Image::ImageRgba32F(image) => visit(image.as_raw(), |&[r, g, b, alpha]: &[f32; 4]| ([r, g, b], alpha), f),
        // No codec has other layouts today.
        other => for_each(&Image::ImageRgba32F(other.to_rgba32f()), f),
    }
}

fn visit<T: Copy + Into<f32>, const N: usize>(
    samples: &[T],
    split: impl Fn(&[T; N]) -> ([T; 3], T),
    mut f: impl FnMut([f32; 3], f32),
) {
    for pixel in samples.as_chunks().0 {
        let (color, alpha) = split(pixel);
        f(color.map(Into::into), alpha.into());
    }
}
