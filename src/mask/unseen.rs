//! Replacement of pixels that do not show the scene: a kernel has to read some value there.

use super::Mask;
use crate::image::{Luma, Size};

/// The view with each unseen pixel replaced by the nearest seen one of its row, the left one of two; a row without any is
/// the nearest row that has some, the upper one of two. So the edge of the mask bears no interest points. A view of which
/// nothing is seen stays as it is.
pub(crate) fn extended(luma: &Luma, mask: &Mask) -> Luma {
    let Size { width, height } = luma.size();
    let mut out = luma.clone();
    let seen_rows: Vec<u32> = (0..height).filter(|&y| mask.row(y).iter().any(|&value| value != 0)).collect();
    for &y in &seen_rows {
        let seen: Vec<u32> = (0..width).filter(|&x| mask.get(x, y) != 0).collect();
        (0..width).for_each(|x| out.set(x, y, luma.get(nearest(&seen, x), y)));
    }
    if !seen_rows.is_empty() {
        for y in 0..height {
            let from = nearest(&seen_rows, y);
            (0..width).for_each(|x| out.set(x, y, out.get(x, from)));
        }
    }
    out
}

/// The view with noise in place of the unseen pixels. Noise of another `seed` corresponds to it nowhere, so that no path carries
/// a disparity through it and no pixel there, nor one whose partner is there, passes the left-right consistency check.
pub(crate) fn drowned(luma: &Luma, mask: &Mask, seed: u32) -> Luma {
    let Size { width, height } = luma.size();
    Luma::from_fn((width, height), |x, y| if mask.get(x, y) == 0 { noise(x, y, seed) } else { luma.get(x, y) })
}

/// The same value for the same arguments, 0 to 255.
fn noise(x: u32, y: u32, seed: u32) -> u8 {
    // Multipliers of xxHash32, and shifts that carry the upper bits down.
    let mixed = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x27D4_EB2F);
    (mixed ^ mixed >> 13) as u8
}

/// The nearest of `sorted` places, the smaller one of two.
fn nearest(sorted: &[u32], place: u32) -> u32 {
    let after = sorted.partition_point(|&other| other < place);
    let candidates = [after.checked_sub(1), Some(after)].into_iter().flatten().filter_map(|index| sorted.get(index));
    *candidates.min_by_key(|other| other.abs_diff(place)).expect("there is a seen pixel")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_another_in_another_view() {
        let view = Luma::filled((64, 64), 100);
        let mask = Mask::from_fn((64, 64), |x, _| if x < 32 { 0 } else { 255 });
        let (left, right) = (drowned(&view, &mask, 0), drowned(&view, &mask, 1));
        let spread =
            |view: &Luma| (0..64).map(|y| view.row(y)[..32].iter().filter(|&&grey| grey < 128).count()).sum::<usize>();
        assert!((900..1150).contains(&spread(&left)) && (900..1150).contains(&spread(&right)));
        let equal = left.data().iter().zip(right.data()).filter(|(a, b)| a == b).count();
        assert!((32 * 64..32 * 64 + 30).contains(&equal), "{equal}");
    }

    #[test]
    fn by_hand() {
        let luma = Luma::new((4, 3), vec![1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]).unwrap();
        let mask = Mask::new((4, 3), vec![0, 0, 0, 0, 0, 255, 0, 255, 255, 0, 0, 0]).unwrap();
        assert_eq!(extended(&luma, &mask).data(), [6, 6, 6, 8, 6, 6, 6, 8, 9, 9, 9, 9]);
        assert_eq!(extended(&luma, &mask.map(|_| 0)), luma);
        assert_eq!(extended(&luma, &mask.map(|_| 255)), luma);
    }
}
