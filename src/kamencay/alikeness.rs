//! Similarity of the two views around a pixel and its partner, on the host.

use crate::image::{Plane, Size};

/// Radius of the windows, in pixels: they are 9x9.
const RADIUS: i64 = 4;

/// Similarity of the 9x9 windows around a pixel of the left view and its partner in the right view, `disparity` whole
/// pixels to the left, 0 to 127: 127 times their normalised cross-correlation, rounded down; 0 where the correlation is
/// negative or a window is constant. Windows are cut off at the borders of the pictures, and pixels without a partner
/// are left out.
pub(super) fn alikeness([left, right]: [&Plane<u8>; 2], (x, y): (u32, u32), disparity: i32) -> u8 {
    let Size { width, height } = left.size();
    let (x, y, disparity) = (i64::from(x), i64::from(y), i64::from(disparity));
    let rows = (y - RADIUS).max(0)..=(y + RADIUS).min(i64::from(height) - 1);
    // Columns where both the pixel and its partner are inside.
    let first = (x - RADIUS).max(0).max(disparity);
    let last = (x + RADIUS).min(i64::from(width) - 1).min(i64::from(width) - 1 + disparity);
    let (mut count, mut sums, mut squares, mut products) = (0_i64, [0_i64; 2], [0_i64; 2], 0_i64);
    for v in rows {
        for u in first..=last {
            let a = i64::from(left.get(u as u32, v as u32));
            let b = i64::from(right.get((u - disparity) as u32, v as u32));
            count += 1;
            sums[0] += a;
            sums[1] += b;
            squares[0] += a * a;
            squares[1] += b * b;
            products += a * b;
        }
    }
    let covariance = count * products - sums[0] * sums[1];
    let variance = |i: usize| count * squares[i] - sums[i] * sums[i];
    let both = i128::from(variance(0)) * i128::from(variance(1));
    if covariance <= 0 || both == 0 {
        return 0;
    }
    let squared = 127 * 127 * i128::from(covariance) * i128::from(covariance) / both;
    (squared as u32).isqrt() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_brightness_is_none_of_the_look() {
        let left = Plane::from_fn((20, 12), |x, y| ((7 * x + 13 * y * y) % 90) as u8);
        let right = Plane::from_fn((20, 12), |x, y| 2 * left.get((x + 3).min(19), y) + 40);
        for place in [(0, 0), (5, 5), (10, 11), (19, 0)] {
            assert_eq!(alikeness([&left, &right], place, 3), 127, "{place:?}");
        }
        assert!(alikeness([&left, &right], (10, 5), 4) < 100);
    }

    #[test]
    fn opposites_and_flat_windows_are_not_alike() {
        let left = Plane::from_fn((9, 9), |x, y| (20 * x + y) as u8);
        let right = left.map(|&level| 255 - level);
        assert_eq!(alikeness([&left, &right], (4, 4), 0), 0);
        assert_eq!(alikeness([&left, &Plane::filled((9, 9), 7)], (4, 4), 0), 0);
        // No partner at all.
        assert_eq!(alikeness([&left, &left], (1, 1), 9), 0);
    }

    #[test]
    fn half_of_the_look() {
        // Windows of three pixels in a row: 0 0 3 against 0 3 3 correlate by a half.
        let row = |levels: [u8; 3]| Plane::new((3, 1), levels.to_vec()).unwrap();
        assert_eq!(alikeness([&row([0, 0, 3]), &row([0, 3, 3])], (1, 0), 0), 63);
    }
}
