//! The census transform, from the definition.

use crate::image::{Luma, Plane, Size};

/// The census of each pixel: 24 bits that tell which other pixels of its 5x5 window are darker, row by row, the first
/// in the highest bit, above the 8 bits of its luma. Edge pixels are repeated beyond the picture.
pub fn census(luma: &Luma) -> Plane<u32> {
    let Size { width, height } = luma.size();
    Plane::from_fn((width, height), |x, y| {
        let centre = luma.get(x, y);
        let mut bits = 0;
        for (j, i) in (-2..=2).flat_map(|j| (-2..=2).map(move |i| (j, i))) {
            if (i, j) != (0, 0) {
                bits = bits << 1 | u32::from(luma.get_clamped(i64::from(x) + i, i64::from(y) + j) < centre);
            }
        }
        bits << 8 | u32::from(centre)
    })
}
