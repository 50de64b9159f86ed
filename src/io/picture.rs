//! Colour pictures in memory.

use crate::{
    error::{Result, check},
    image::{Luma, Plane, Size, luma_of},
};

/// A colour picture: red, green, blue and alpha, 8 bits each.
///
/// Alpha 0 stands for 'nothing was seen here': the pixel gets no disparity, whatever its colour. Any other alpha stands
/// for a seen pixel, and its value is ignored.
pub type Picture = Plane<[u8; 4]>;

impl Picture {
    /// A picture of `size` from the bytes of its pixels, red, green, blue and alpha, row by row.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] unless `rgba` holds four bytes per pixel.
    pub fn from_rgba8(size: impl Into<Size>, rgba: &[u8]) -> Result<Self> {
        let size = size.into();
        let (pixels, rest) = rgba.as_chunks();
        let expected = format!("{size} pixels need {} bytes", 4 * u128::from(size.pixels()));
        check(
            rest.is_empty() && pixels.len() as u64 == size.pixels(),
            "rgba",
            format_args!("{} bytes", rgba.len()),
            expected,
        )?;
        Self::new(size, pixels.to_vec())
    }

    /// The bytes of the picture, four per pixel, row by row, as for an `Rgba8Unorm` texture or a buffer.
    pub fn rgba(&self) -> &[u8] {
        self.data().as_flattened()
    }

    /// Red, green and blue at `(x, y)`.
    pub fn rgb(&self, x: u32, y: u32) -> [u8; 3] {
        let [red, green, blue, _] = self.get(x, y);
        [red, green, blue]
    }

    /// The grey picture that is matched; alpha is ignored.
    pub fn luma(&self) -> Luma {
        self.map(|&[red, green, blue, _]| luma_of([red, green, blue]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_another_size_are_refused() {
        assert_eq!(
            Picture::from_rgba8((1, 2), &[1, 2, 3, 4, 5, 6, 7, 8]).unwrap().data(),
            [[1, 2, 3, 4], [5, 6, 7, 8]]
        );
        for (size, bytes) in [((1, 2), 7), ((1, 2), 9), ((1, 2), 4), ((u32::MAX, u32::MAX), 0)] {
            let error = Picture::from_rgba8(size, &vec![0; bytes]).unwrap_err().to_string();
            assert!(error.starts_with(&format!("rgba is {bytes} bytes")), "{error}");
        }
    }

    #[test]
    fn luma_ignores_alpha() {
        let picture = Picture::new((2, 1), vec![[10, 20, 30, 0], [255, 0, 0, 255]]).unwrap();
        assert_eq!(picture.luma().data(), [18, 77]);
        assert_eq!(picture.rgba(), [10, 20, 30, 0, 255, 0, 0, 255]);
        assert_eq!(picture.rgb(0, 0), [10, 20, 30]);
    }
}
