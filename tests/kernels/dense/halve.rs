//! Downscaling to half the size.

use hsad::{
    image::{Luma, Size},
    verify::trials::HalveTrial,
};

use crate::common::*;

#[test]
fn the_twin_halves_the_same() {
    for Size { width, height } in SIZES {
        assert_twin(&format!("{width}x{height}"), &HalveTrial(picture((width, height), 71)));
    }
}

#[test]
fn by_hand() {
    // Means of four pixels, of two, and a single pixel, halves up.
    let luma = Luma::new((3, 3), vec![1, 2, 3, 5, 6, 8, 9, 9, 7]).unwrap();
    assert_eq!(leaves(&HalveTrial(luma))[0], vec![0x0604_u32, 0x0709].into());
}
