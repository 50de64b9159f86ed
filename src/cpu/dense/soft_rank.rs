//! Soft ranks, from the definition.

use crate::{
    dense::kernels::{SOFT_RANK_LIMIT, SOFT_RANK_MIDDLE},
    image::{Luma, Size},
};

/// The neighbours that count: column and row from the pixel, and weight.
const NEIGHBOURS: [(i64, i64, i32); 10] = [
    (-4, 0, 1),
    (-3, 0, 1),
    (3, 0, 1),
    (4, 0, 1),
    (0, -2, 2),
    (0, 2, 2),
    (-2, -2, 1),
    (2, -2, 1),
    (-2, 2, 1),
    (2, 2, 1),
];

/// The soft rank of each pixel: [`SOFT_RANK_MIDDLE`] plus the weighted sum of the differences of its ten neighbours from
/// it, each limited to [`SOFT_RANK_LIMIT`] to either side. Edge pixels repeat beyond the picture.
pub fn soft_rank(luma: &Luma) -> Luma {
    let Size { width, height } = luma.size();
    Luma::from_fn((width, height), |x, y| {
        let centre = i32::from(luma.get(x, y));
        let excess = |(dx, dy, weight)| {
            let neighbour = i32::from(luma.get_clamped(i64::from(x) + dx, i64::from(y) + dy));
            weight * (neighbour - centre).clamp(-SOFT_RANK_LIMIT, SOFT_RANK_LIMIT)
        };
        (SOFT_RANK_MIDDLE + NEIGHBOURS.map(excess).iter().sum::<i32>()) as u8
    })
}
