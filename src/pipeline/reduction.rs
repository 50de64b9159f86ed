//! Size at which interest points are detected.

use crate::image::Size;

/// Largest number of pixels of a picture in which interest points are detected; larger pictures are downscaled first.
const MAX_SPARSE_PIXELS: u64 = 1 << 21;

/// The integer factor by which a pair is downscaled before interest points are detected. A few thousand points determine
/// range, rectification and brightness, and the time to match points grows with the square of their number.
pub fn reduction(size: impl Into<Size>) -> u32 {
    let pixels = size.into().pixels();
    (1..).find(|&factor| pixels <= MAX_SPARSE_PIXELS * u64::from(factor).pow(2)).unwrap_or(1)
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
    }
}
