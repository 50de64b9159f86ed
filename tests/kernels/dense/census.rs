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
    // One dark pixel in the middle of 5x5 others: it sees no darker one, and each of the others sees it
    // where it stands in their window.
    let luma = Luma::from_fn((5, 5), |x, y| if (x, y) == (2, 2) { 10 } else { 20 });
    let [Values::U32(census)] = &leaves(&CensusTrial(luma))[..] else { panic!("one word a pixel") };
    assert_eq!(census[12], 10);
    // Two to the right and two below of the first, so the last of its 24 bits; the first of the last one's.
    assert_eq!(census[0], 1 << 8 | 20);
    assert_eq!(census[24], 1 << 31 | 20);
}
