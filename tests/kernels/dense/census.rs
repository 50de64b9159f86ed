//! The census transform.

use hsad::{
    image::{Luma, Size},
    verify::{Values, trials::CensusTrial},
};

use crate::common::*;

#[test]
fn the_twin_transforms_the_same() {
    for Size { width, height } in SIZES {
        assert_twin(&format!("{width}x{height}"), &CensusTrial(picture((width, height), 61)));
    }
}

#[test]
fn by_hand() {
    // One dark pixel in the middle of 5x5 pixels: no pixel is darker than it, and each other pixel has it at its place
    // in the window.
    let luma = Luma::from_fn((5, 5), |x, y| if (x, y) == (2, 2) { 10 } else { 20 });
    let [Values::U32(census)] = &leaves(&CensusTrial(luma))[..] else { panic!("one word per pixel") };
    assert_eq!(census[12], 10);
    // The dark pixel is two columns to the right of the first pixel and two rows below, so the last of its 24 bits; for
    // the last pixel it is the first bit.
    assert_eq!(census[0], 1 << 8 | 20);
    assert_eq!(census[24], 1 << 31 | 20);
}
