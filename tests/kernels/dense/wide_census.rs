//! The wide census transform.

use hsad::{
    image::{Luma, Size},
    verify::{Values, trials::WideCensusTrial},
};

use crate::common::*;

fn trial(picture: Luma, spread: u32) -> WideCensusTrial {
    WideCensusTrial { picture, spread, offset: 3 }
}

#[test]
fn the_twin_transforms_the_same() {
    for Size { width, height } in SIZES {
        for spread in [0, 300, 2295] {
            assert_twin(&format!("{width}x{height} {spread}"), &trial(picture((width, height), 62), spread));
        }
    }
}

#[test]
fn by_hand() {
    // One pixel, darker by 10: the sums of its 3x3 pixels are smaller than all others, by 10.
    let luma = Luma::from_fn((21, 21), |x, y| if (x, y) == (10, 10) { 10 } else { 20 });
    let at = |spread, (x, y): (usize, usize)| {
        let [Values::U32(census)] = &leaves(&trial(luma.clone(), spread))[..] else { panic!("one word per pixel") };
        census[y * 21 + x]
    };
    // No sum is smaller than that around the dark pixel. Four columns to the right of a pixel and four rows below it, the
    // dark pixel is the last of its 24 neighbours; two rows above it, the eighth.
    assert_eq!(at(9, (10, 10)), 0);
    assert_eq!(at(9, (6, 6)), 1 << 8);
    assert_eq!(at(9, (10, 12)), 1 << (8 + 24 - 8));
    // Five columns away, the dark pixel is still in the 3x3 pixels of the neighbour; six columns away it is not.
    assert_eq!((at(9, (5, 10)) >> 8 != 0, at(9, (4, 10)) >> 8 != 0), (true, false));
    // Weak texture: the sums differ by 10 at most, or not at all.
    assert_eq!((at(10, (10, 10)), at(9, (4, 10)), at(0, (4, 10))), (1, 1, 1));
}
