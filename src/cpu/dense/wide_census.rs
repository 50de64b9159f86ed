//! The wide census transform, from the definition.

use crate::image::{Luma, Plane, Size};

/// The wide census of each pixel: 24 bits for the neighbours of the 5x5 window, row by row, the first in the highest bit.
/// Every second bit, from the first on, tells whether the 3x3 lumas around the neighbour at twice the distance have a
/// smaller sum than those around the pixel; the others, whether the neighbour is darker. Below them 8 bits: 1 where the
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
        let (centre, sum) = (luma.get(x, y), sums.get(x + 4, y + 4));
        let (mut bits, mut least, mut largest) = (0, sum, sum);
        for (j, i) in (0..5).flat_map(|j| (0..5).map(move |i| (j, i))) {
            let is_less = if (i + j) % 2 == 0 {
                let other = sums.get(x + 2 * i, y + 2 * j);
                (least, largest) = (least.min(other), largest.max(other));
                other < sum
            } else {
                luma.get_clamped(i64::from(x + i) - 2, i64::from(y + j) - 2) < centre
            };
            if (i, j) != (2, 2) {
                bits = bits << 1 | u32::from(is_less);
            }
        }
        bits << 8 | u32::from(largest - least <= spread)
    })
}
