//! Detail: how much of the differences of a view lies between near pixels, as in fine texture, and not between far ones alone, as
//! where the view is blurred or nearly plain.

use rayon::prelude::*;

use crate::image::{Luma, Plane, Size};

/// Side of a cell, in pixels.
pub(crate) const CELL: u32 = 16;
/// Half of the distance of the pixels that are compared, the near and the far ones, in pixels.
const REACH: [u32; 2] = [1, 4];

/// The detail of a view in each of its cells of 16x16 pixels, along rows and along columns, in thousandths.
///
/// The detail of a cell is the sum of `|I(x - 1) - I(x + 1)|` in the cell and in the eight around it, as a share of the sum of
/// `|I(x - 4) - I(x + 4)|`: 0.25 for a ramp, for what is blurred, and for lone edges; 1 for noise and fine texture.
pub(crate) fn detail(view: &Luma) -> Plane<[u32; 2]> {
    let Size { width, height } = view.size();
    let (columns, rows) = (width.div_ceil(CELL), height.div_ceil(CELL));
    let sums: Vec<[u64; 4]> =
        (0..columns * rows).into_par_iter().map(|cell| differences(view, [cell % columns, cell / columns])).collect();
    let around = |at: u32, count: u32| at.saturating_sub(1)..count.min(at + 2);
    Plane::from_fn((columns, rows), |x, y| {
        let cells = around(y, rows).flat_map(|j| around(x, columns).map(move |i| (j * columns + i) as usize));
        let [near, far, below, far_below] = cells.fold([0; 4], |sum, cell| {
            let own = sums[cell];
            [0, 1, 2, 3].map(|part| sum[part] + own[part])
        });
        [(near, far), (below, far_below)].map(|(near, far)| (1000 * near / far.max(1)) as u32)
    })
}

/// Sums of the differences in a cell: of near and of far pixels, along rows and along columns.
fn differences(view: &Luma, cell: [u32; 2]) -> [u64; 4] {
    let Size { width, height } = view.size();
    let far = REACH[1];
    let inside = |cell: u32, length: u32| cell * CELL..length.min((cell + 1) * CELL);
    let mut sums = [0_u64; 4];
    for (x, y) in inside(cell[1], height).flat_map(|y| inside(cell[0], width).map(move |x| (x, y))) {
        if (far..width.saturating_sub(far)).contains(&x) {
            for (sum, reach) in sums[..2].iter_mut().zip(REACH) {
                *sum += u64::from(view.get(x - reach, y).abs_diff(view.get(x + reach, y)));
            }
        }
        if (far..height.saturating_sub(far)).contains(&y) {
            for (sum, reach) in sums[2..].iter_mut().zip(REACH) {
                *sum += u64::from(view.get(x, y - reach).abs_diff(view.get(x, y + reach)));
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detail_by_hand() {
        let of = |grey: fn(u32, u32) -> u32| detail(&Luma::from_fn((70, 50), |x, y| grey(x, y) as u8)).get(1, 1);
        // Ramps: 2 px of 8.
        assert_eq!(of(|x, y| 2 * x + y), [250, 250]);
        assert_eq!(of(|x, _| 3 * x), [250, 0]);
        // An edge lies between two near pairs of pixels per row, and between eight far ones; a line at one end of two of either.
        assert_eq!(of(|x, _| if x < 35 { 10 } else { 90 }), [250, 0]);
        assert_eq!(of(|x, _| if x == 35 { 90 } else { 10 }), [1000, 0]);
        // What repeats every three pixels: as far apart two away as eight.
        assert_eq!(of(|x, y| 30 * (x % 3) + 50 * (y % 3)), [1000, 1000]);
        assert_eq!(of(|_, _| 7), [0, 0]);
    }

    #[test]
    fn views_smaller_than_the_reach_have_none() {
        for size in [(1, 1), (8, 3), (5, 40)] {
            let Size { width, height } = size.into();
            let detail = detail(&Luma::from_fn(size, |x, y| (40 * x + 9 * y) as u8));
            let [along_rows, _] = detail.get((width - 1) / CELL, (height - 1) / CELL);
            assert_eq!(along_rows, 0);
        }
    }
}
