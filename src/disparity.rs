//! Disparities in fixed point, and ranges of them.

use crate::{
    error::{Error, Result},
    image::Plane,
};

/// Fixed-point steps per pixel: disparities are in 1/256 px, so that KITTI 16-bit PNGs are kept exactly.
pub const SCALE: i32 = 256;

/// The sentinel of a pixel without disparity. Zero is a disparity like any other.
pub const NONE: i32 = i32::MIN;

/// The sentinel in a texture of disparities in pixels: [`NONE`] / [`SCALE`], below every disparity; finite
/// because WGSL does not guarantee infinities and NaN.
pub const NONE_IN_PIXELS: f32 = NONE as f32 / SCALE as f32;

/// Largest distance of a disparity from an end of a range that counts as the end, in 1/256 px.
pub(crate) const AT_END: i32 = 3 * SCALE / 2;

/// One disparity per pixel, in 1/256 px, or [`NONE`].
///
/// In the left view's map, pixel `(x, y)` with disparity `d` corresponds to `(x - d, y)` of the
/// right view; in the right view's map, `(x, y)` corresponds to `(x + d, y)` of the left.
pub type DisparityMap = Plane<i32>;

/// Converts a fixed-point disparity to pixels; `None` for [`NONE`].
pub fn pixels(disparity: i32) -> Option<f32> {
    (disparity != NONE).then(|| disparity as f32 / SCALE as f32)
}

/// Converts a disparity in pixels to fixed point, rounded, halves away from 0; [`NONE`] for infinities and NaN.
pub fn fixed_point(pixels: f32) -> i32 {
    // The cast saturates; its lower end is NONE itself.
    if pixels.is_finite() { ((pixels * SCALE as f32).round() as i32).max(NONE + 1) } else { NONE }
}

/// Converts a map to pixels, with +inf for [`NONE`].
pub fn in_pixels(map: &DisparityMap) -> Plane<f32> {
    map.map(|&d| pixels(d).unwrap_or(f32::INFINITY))
}

/// The share of pixels that have a disparity, 0 to 1.
pub fn coverage(map: &DisparityMap) -> f64 {
    map.data().iter().filter(|&&d| d != NONE).count() as f64 / map.data().len() as f64
}

/// The whole-pixel disparities of a search: `min`, `min + 1`, ..., `min + count - 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DisparityRange {
    /// The smallest disparity, in pixels; may be negative.
    pub min: i32,
    /// Number of disparities, at least 1.
    pub count: u32,
}

impl DisparityRange {
    /// Largest accepted magnitude of a disparity, in pixels.
    pub const LIMIT: i32 = 1 << 20;

    /// Disparities of volumes for a range of `count`: rounded up to whole sixteens, packed in four `u32` that kernels load at
    /// once. What is more than the range is never selected.
    pub(crate) const fn padded(count: u32) -> u32 {
        count.next_multiple_of(16)
    }

    /// A range of `count` disparities from `min`, in whole pixels.
    ///
    /// # Errors
    /// [`Error::Parameter`] if `count` is 0 or an end lies beyond [`Self::LIMIT`].
    pub fn new(min: i32, count: u32) -> Result<Self> {
        if count == 0 {
            return Err(Error::Parameter {
                name: "the number of disparities",
                value: "0".into(),
                expected: "it must be at least 1".into(),
            });
        }
        let last = i64::from(min) + i64::from(count) - 1;
        let limit = i64::from(Self::LIMIT);
        if i64::from(min) < -limit || last > limit {
            return Err(Error::Parameter {
                name: "the disparity range",
                value: format!("{min} to {last}"),
                expected: format!("it must lie within -{limit} and {limit}"),
            });
        }
        Ok(Self { min, count })
    }

    /// A range from its smallest to its largest disparity, both included, in whole pixels.
    ///
    /// # Errors
    /// See [`Self::new`]; also if `last` is below `first`.
    pub fn inclusive(first: i32, last: i32) -> Result<Self> {
        let count = i64::from(last) - i64::from(first) + 1;
        Self::new(first, u32::try_from(count).unwrap_or(0))
    }

    /// The largest disparity, in pixels.
    pub fn last(&self) -> i32 {
        self.min + (self.count - 1) as i32
    }

    /// Whether a disparity, in 1/256 px, lies within 1.5 px of the smallest and of the largest disparity of the range, beyond which
    /// the surface may go on.
    pub(crate) fn is_at_end(&self, disparity: i32) -> [bool; 2] {
        let known = disparity != NONE;
        [known && disparity <= SCALE * self.min + AT_END, known && disparity >= SCALE * self.last() - AT_END]
    }

    /// Whether `disparity`, in whole pixels, lies in the range.
    pub fn contains(&self, disparity: i32) -> bool {
        (self.min..=self.last()).contains(&disparity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_and_fixed_point_by_hand() {
        let pixels = [0.0, -1.5, 1.0 / 512.0, -1.0 / 512.0, f32::MAX, f32::MIN, f32::INFINITY, f32::NAN];
        assert_eq!(pixels.map(fixed_point), [0, -384, 1, -1, i32::MAX, NONE + 1, NONE, NONE]);
        let map = DisparityMap::new((3, 1), vec![384, NONE, -1]).unwrap();
        assert_eq!(in_pixels(&map).data(), [1.5, f32::INFINITY, -1.0 / 256.0]);
    }
}
