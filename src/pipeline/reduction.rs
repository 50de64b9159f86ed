//! Size at which interest points are detected.

use crate::image::Size;

/// Largest number of pixels of a picture in which interest points are detected; larger pictures are downscaled first.
const MAX_SPARSE_PIXELS: u64 = 1 << 21;

/// Largest number of pixels of a picture in which the points are detected that a rectification is found by, or measured: a pair
/// is matched up to three times for that.
const MAX_GEOMETRY_PIXELS: u64 = 1 << 19;

/// The integer factor by which a pair is downscaled before interest points are detected. A few thousand points determine
/// range, rectification and brightness, and the time to match points grows with the square of their number.
pub fn reduction(size: impl Into<Size>) -> u32 {
    factor(size.into(), MAX_SPARSE_PIXELS)
}

/// The integer factor by which a pair is downscaled before points are detected to find a rectification by, or to measure it.
pub(super) fn geometry_reduction(size: Size) -> u32 {
    factor(size, MAX_GEOMETRY_PIXELS)
}

/// The least integer factor after which no more than `most` pixels are left.
fn factor(size: Size, most: u64) -> u32 {
    (1..).find(|&factor| size.pixels() <= most * u64::from(factor).pow(2)).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_reduced() {
        assert_eq!(reduction((1, 1)), 1);
        assert_eq!(reduction((2048, 1024)), 1);
        assert_eq!(reduction((2048, 1025)), 2);
        // 24 megapixels in blocks of 16 are 1.5.
        assert_eq!(reduction((6000, 4000)), 4);
        assert_eq!([(960, 540), (1920, 1080), (1922, 1092)].map(|size| geometry_reduction(size.into())), [1, 2, 3]);
    }
}
