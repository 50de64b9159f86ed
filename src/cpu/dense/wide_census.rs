//! The wide census transform, from the definition.

use crate::image::{Luma, Plane, Size};

/// The wide census of each pixel: 24 bits that tell around which of 5x5 pixels, two columns and two rows apart, the 3x3
/// lumas have a smaller sum than around the pixel, row by row, the first in the highest bit, above 8 bits: 1 where the 25
/// sums differ by at most `spread`, 0 elsewhere. Edge pixels are repeated beyond the picture.
pub fn wide_census(luma: &Luma, spread: u32) -> Plane<u32> {
    let Size { width, height } = luma.size();
    // With the neighbours beyond the picture, four on either side.
    let sums = Plane::from_fn((width + 8, height + 8), |x, y| {
        let (x, y) = (i64::from(x) - 4, i64::from(y) - 4);
        let lumas = (-1..=1).flat_map(|j| (-1..=1).map(move |i| luma.get_clamped(x + i, y + j)));
        lumas.map(u32::from).sum::<u32>()
    });
    Plane::from_fn((width, height), |x, y| {
        let centre = sums.get(x + 4, y + 4);
        let (mut bits, mut least, mut largest) = (0, centre, centre);
        for (j, i) in (0..5).flat_map(|j| (0..5).map(move |i| (j, i))) {
            if (i, j) != (2, 2) {
                let other = sums.get(x + 2 * i, y + 2 * j);
                bits = bits << 1 | u32::from(other < centre);
                (least, largest) = (least.min(other), largest.max(other));
            }
        }
        bits << 8 | u32::from(largest - least <= spread)
    })
}
