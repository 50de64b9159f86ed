//! Replacement of pixels that do not show the scene: a kernel has to read some value there.

use super::Mask;
use crate::image::{Luma, Size};

/// The view with each unseen pixel replaced by the nearest seen one of its row, the left one of two; a row without any is
/// the nearest row that has some, the upper one of two. So the edge of the mask bears no interest points. A view of which
/// nothing is seen stays as it is.
pub(crate) fn extended(luma: &Luma, mask: &Mask) -> Luma {
    let Size { width, height } = luma.size();
    let seen_rows = (0..height).map(|y| mask.row(y).iter().any(|&value| value != 0));
    let Some(rows) = nearest(seen_rows) else { return luma.clone() };
    let mut data = Vec::with_capacity(luma.data().len());
    let mut columns: Option<(u32, Vec<u32>)> = None;
    for from in rows {
        if columns.as_ref().is_none_or(|(row, _)| *row != from) {
            columns = nearest(mask.row(from).iter().map(|&value| value != 0)).map(|columns| (from, columns));
        }
        let row = luma.row(from);
        data.extend(columns.iter().flat_map(|(_, columns)| columns).map(|&x| row[x as usize]));
    }
    Luma::new((width, height), data).expect("a value per pixel")
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

/// For each place the nearest one that is seen, the smaller one of two; `None` if none is seen.
fn nearest(seen: impl Iterator<Item = bool>) -> Option<Vec<u32>> {
    let mut nearest: Vec<u32> = Vec::new();
    let mut last: Option<u32> = None;
    for (place, is_seen) in (0..).zip(seen) {
        if is_seen {
            // Of the places since the last one that is seen, those after the middle are nearer to this one.
            let from = last.map_or(0, |last| (last + place) / 2 + 1);
            nearest.resize(from as usize, last.unwrap_or(0));
            nearest.resize(place as usize + 1, place);
            last = Some(place);
        } else {
            nearest.push(last.unwrap_or(0));
        }
    }
    last.map(|_| nearest)
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
