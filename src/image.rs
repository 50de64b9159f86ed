//! Planes of values, and luma, the only picture that the kernels see.

use crate::error::{Error, Result};

/// A `width` x `height` grid of values in row-major order, the origin at the top left.
///
/// Never empty: both sides are at least 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plane<T> {
    width: u32,
    height: u32,
    data: Vec<T>,
}

/// An 8-bit grey picture, 0 to 255.
pub type Luma = Plane<u8>;

/// Luma as the kernels read it: rows of `width.div_ceil(4)` words, pixel x in byte x % 4 (the lowest
/// first) of word x / 4, zeros behind the last.
pub fn pack(luma: &Luma) -> Vec<u32> {
    let mut words = Vec::with_capacity(luma.width.div_ceil(4) as usize * luma.height as usize);
    for row in luma.data.chunks(luma.width as usize) {
        words.extend(row.chunks(4).map(|four| {
            let mut bytes = [0; 4];
            bytes[..four.len()].copy_from_slice(four);
            u32::from_le_bytes(bytes)
        }));
    }
    words
}

impl<T> Plane<T> {
    /// Wraps `data`, row by row.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a side is 0 or `data` does not hold `width * height` values.
    pub fn new(width: u32, height: u32, data: Vec<T>) -> Result<Self> {
        if width == 0 || height == 0 || data.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(Error::Parameter {
                name: "picture",
                value: format!("{width}x{height} with {} values", data.len()),
                expected: "it needs width x height values and no side of 0".into(),
            });
        }
        Ok(Self { width, height, data })
    }

    /// The value of `f(x, y)` everywhere.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn from_fn(width: u32, height: u32, mut f: impl FnMut(u32, u32) -> T) -> Self {
        assert!(width > 0 && height > 0, "a plane of {width}x{height} is empty");
        let data = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| f(x, y)).collect();
        Self { width, height, data }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Width and height.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// All values, row by row.
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All values, row by row, to be changed.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// All values, row by row.
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// Row `y`.
    pub fn row(&self, y: u32) -> &[T] {
        let width = self.width as usize;
        &self.data[y as usize * width..][..width]
    }

    /// A plane of the same size with `f` of each value.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Plane<U> {
        Plane { width: self.width, height: self.height, data: self.data.iter().map(f).collect() }
    }
}

impl<T: Copy> Plane<T> {
    /// `value` everywhere.
    ///
    /// # Panics
    /// If a side is 0.
    pub fn filled(width: u32, height: u32, value: T) -> Self {
        Self::from_fn(width, height, |_, _| value)
    }

    /// The value at `(x, y)`.
    pub fn get(&self, x: u32, y: u32) -> T {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.data[y as usize * self.width as usize + x as usize]
    }

    /// Sets the value at `(x, y)`.
    pub fn set(&mut self, x: u32, y: u32, value: T) {
        assert!(x < self.width, "column {x} of {}", self.width);
        self.data[y as usize * self.width as usize + x as usize] = value;
    }

    /// The value at the pixel of the plane that is nearest to `(x, y)`: the edge goes on for ever.
    pub fn get_clamped(&self, x: i64, y: i64) -> T {
        let x = x.clamp(0, i64::from(self.width) - 1) as u32;
        let y = y.clamp(0, i64::from(self.height) - 1) as u32;
        self.get(x, y)
    }
}
