//! The census transforms.

use hsad::{
    gpu::Windows,
    image::{Luma, Size},
    verify::{Values, trials::CensusTrial},
};

use crate::common::*;

/// The census and the wide census of each pixel.
fn transforms(picture: &Luma, weak_spread: Option<u32>, windows: Windows) -> Vec<[u32; 2]> {
    let trial = CensusTrial { picture: picture.clone(), weak_spread, windows };
    let Values::U32(words) = leaves(&trial).remove(0) else { panic!("words") };
    words.as_chunks().0.to_vec()
}

#[test]
fn the_twin_transforms_the_same() {
    for Size { width, height } in SIZES {
        for weak_spread in [None, Some(0), Some(300), Some(2295)] {
            for windows in Windows::ALL {
                let trial = CensusTrial { picture: picture((width, height), 61), weak_spread, windows };
                assert_twin(&format!("{width}x{height} {weak_spread:?} {windows:?}"), &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    // One dark pixel in the middle of 5x5 pixels: no pixel is darker than it, and each other pixel has it at its place
    // in the window.
    let luma = Luma::from_fn((5, 5), |x, y| if (x, y) == (2, 2) { 10 } else { 20 });
    for windows in Windows::ALL {
        let census = transforms(&luma, None, windows);
        assert_eq!(census[12], [10, 0]);
        // The dark pixel is two columns to the right of the first pixel and two rows below, so the last of its 24 bits; for
        // the last pixel it is the first bit.
        assert_eq!(census[0], [1 << 8 | 20, 0]);
        assert_eq!(census[24], [1 << 31 | 20, 0]);
    }
}

#[test]
fn wide_by_hand() {
    // One pixel, darker by 10: the sums of its 3x3 pixels are smaller than all others, by 10.
    let luma = Luma::from_fn((21, 21), |x, y| if (x, y) == (10, 10) { 10 } else { 20 });
    for windows in Windows::ALL {
        let at = |spread, (x, y): (usize, usize)| transforms(&luma, Some(spread), windows)[y * 21 + x][1];
        // No sum is smaller than that around the dark pixel, and no pixel is darker. Four columns to the right of a pixel and
        // four rows below it, the dark pixel is the last of its 24 neighbours; four rows above it, the third.
        assert_eq!(at(9, (10, 10)), 0);
        assert_eq!(at(9, (6, 6)), 1 << 8);
        assert_eq!(at(9, (10, 14)), 1 << (8 + 24 - 3));
        // One row below a pixel, the dark pixel is the 17th neighbour, and no sum counts beside it.
        assert_eq!(at(9, (10, 9)), 1 << (8 + 24 - 17));
        // Five columns away, the dark pixel is still in the 3x3 pixels of the neighbour; six columns away it is not.
        assert_eq!((at(9, (5, 10)) >> 8 != 0, at(9, (4, 10)) >> 8 != 0), (true, false));
        // Weak texture: the sums differ by 10 at most, or not at all.
        assert_eq!((at(10, (10, 10)), at(9, (4, 10)), at(0, (4, 10))), (1, 1, 1));
    }
}
