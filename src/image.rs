//! Planes of values, and luma, the picture format of the kernels.

use std::ops::Range;

use crate::error::{Error, Result};
pub use crate::size::Size;

/// A `width` x `height` grid of values in row-major order, the origin at the top left.
///
/// Never empty: both sides are at least 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plane<T> {
    size: Size,
    data: Vec<T>,
}

/// An 8-bit grey picture, 0 to 255.
pub type Luma = Plane<u8>;

/// The grey value of a colour: `(77 R + 150 G + 29 B + 128) >> 8`, the weights of ITU-R BT.601 in
/// 1/256, rounded.
pub const fn luma_of([red, green, blue]: [u8; 3]) -> u8 {
    ((77 * red as u32 + 150 * green as u32 + 29 * blue as u32 + 128) >> 8) as u8
}

/// Downscales by an integer `factor`: each pixel is the rounded mean of a block of `factor` x `factor` pixels, cut off
/// at the edges of the picture.
///
/// # Panics
/// If `factor` is 0.
pub fn reduced(luma: &Luma, factor: u32) -> Luma {
    let Size { width, height } = luma.size();
    Luma::from_fn((width.div_ceil(factor), height.div_ceil(factor)), |x, y| {
        let columns = x * factor..((x + 1) * factor).min(width);
        let (mut sum, mut count) = (0, 0);
        for row in y * factor..((y + 1) * factor).min(height) {
            let pixels = &luma.row(row)[columns.start as usize..columns.end as usize];
            sum += pixels.iter().map(|&pixel| u64::from(pixel)).sum::<u64>();
            count += pixels.len() as u64;
        }
        ((sum + count / 2) / count) as u8
    })
}

impl<T> Plane<T> {
    /// Wraps `data`, row by row.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a side is 0 or `data` does not hold `width * height` values.
    pub fn new(size: impl Into<Size>, data: Vec<T>) -> Result<Self> {
        let size = size.into();
        let Size { width, height } = size;
        if width == 0 || height == 0 || data.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(Error::Parameter {
                name: "picture",
                value: format!("{size} with {} values", data.len()),
                expected: "it needs width x height values and no side of 0".into(),
            });
        }
        Ok(Self { size, data })
    }

    /// A plane of the values `f(x, y)`, called row by row.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn from_fn(size: impl Into<Size>, mut f: impl FnMut(u32, u32) -> T) -> Self {
        let size = size.into();
        let Size { width, height } = size;
        assert!(width > 0 && height > 0, "a plane of {width}x{height} is empty");
        // Not collected: an iterator over rows of pixels does not tell their number, and a list that grows takes twice the
        // memory.
        let mut data = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            data.extend((0..width).map(|x| f(x, y)));
        }
        Self { size, data }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.size.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.size.height
    }

    /// Width and height, in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// All values, row by row.
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All values, row by row, mutable.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// Unwraps the values, row by row.
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// The values of row `y`.
    pub fn row(&self, y: u32) -> &[T] {
        let width = self.size.width as usize;
        &self.data[y as usize * width..][..width]
    }

    /// Applies `f` to each value.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Plane<U> {
        Plane { size: self.size, data: self.data.iter().map(f).collect() }
    }
}

impl<T: Copy> Plane<T> {
    /// The given rows as a plane of their own.
    ///
    /// # Panics
    /// Without rows, or for rows beyond the last.
    pub(crate) fn cut(&self, rows: Range<u32>) -> Self {
        assert!(!rows.is_empty(), "a plane without rows is empty");
        let width = self.size.width as usize;
        let data = self.data[rows.start as usize * width..rows.end as usize * width].to_vec();
        Self { size: Size::new(self.size.width, rows.end - rows.start), data }
    }

    /// A plane with `value` everywhere.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn filled(size: impl Into<Size>, value: T) -> Self {
        Self::from_fn(size, |_, _| value)
    }

    /// The value at `(x, y)`.
    pub fn get(&self, x: u32, y: u32) -> T {
        assert!(x < self.size.width, "column {x} of {}", self.size.width);
        self.data[y as usize * self.size.width as usize + x as usize]
    }

    /// Sets the value at `(x, y)`.
    pub fn set(&mut self, x: u32, y: u32, value: T) {
        assert!(x < self.size.width, "column {x} of {}", self.size.width);
        self.data[y as usize * self.size.width as usize + x as usize] = value;
    }

    /// The value at `(x, y)`, with coordinates clamped to the plane.
    pub fn get_clamped(&self, x: i64, y: i64) -> T {
        let x = x.clamp(0, i64::from(self.size.width) - 1) as u32;
        let y = y.clamp(0, i64::from(self.size.height) - 1) as u32;
        self.get(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_picture_by_hand() {
        let luma = Luma::new((3, 3), vec![1, 2, 10, 3, 5, 20, 7, 8, 9]).unwrap();
        // 11 / 4 = 2.75; 30 / 2; 15 / 2 = 7.5, up; 9.
        assert_eq!(reduced(&luma, 2), Luma::new((2, 2), vec![3, 15, 8, 9]).unwrap());
        assert_eq!(reduced(&luma, 1), luma);
    }

    #[test]
    fn rows_are_cut_out() {
        let luma = Luma::new((2, 3), vec![1, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!(luma.cut(1..3), Luma::new((2, 2), vec![3, 4, 5, 6]).unwrap());
        assert_eq!(luma.cut(0..3), luma);
    }

    #[test]
    fn luma_of_known_colours() {
        assert_eq!(luma_of([0, 0, 0]), 0);
        assert_eq!(luma_of([255, 255, 255]), 255);
        // 77 * 255 = 19635, + 128 = 19763, / 256 = 77.2
        assert_eq!(luma_of([255, 0, 0]), 77);
        // 77 * 10 + 150 * 20 + 29 * 30 + 128 = 4768, / 256 = 18.6
        assert_eq!(luma_of([10, 20, 30]), 18);
    }

    #[test]
    fn luma_keeps_grey() {
        for grey in 0..=255 {
            assert_eq!(luma_of([grey; 3]), grey);
        }
    }
}
