//! Bitmaps of the pixels that have a disparity.

use hsad::{
    disparity::NONE,
    image::{Luma, Plane, Size},
    verify::{Values, trials::BitmapTrial},
};

use crate::common::*;

#[test]
fn the_twin_marks_the_same() {
    for Size { width, height } in SIZES {
        for holes in [0, 60, 200] {
            let disparities = picture((width, height), 151).map(|&value| match value {
                value if value < holes => NONE,
                value => i32::from(value),
            });
            assert_twin(&format!("{width}x{height}, {holes}"), &BitmapTrial { disparities, shown: None });
        }
    }
}

#[test]
fn by_hand() {
    // 40x34 pixels, and a disparity in column 33 of rows 1 and 33.
    let disparities = Plane::from_fn((40, 34), |x, y| if x == 33 && y % 32 == 1 { 0 } else { NONE });
    // A mask with a row above the map, which shows rows 1 and 2 from column 31 on.
    let mask = Luma::from_fn((40, 35), |x, y| if x > 30 && (2..4).contains(&y) { 255 } else { 0 });
    let found = leaves(&BitmapTrial { disparities, shown: Some((mask, 1)) });
    let [Values::U32(words)] = &found[..] else { panic!("the words of the bitmaps") };
    // Rows of two words: bit 1 of the second word. Then for shears of -1, 0 and 1 two blocks of 32 + 40 + 32 columns: bit 1 of
    // the word whose diagonal passes column 33 in the second row of the block.
    let mut expected = vec![0; 34 * 2 + 3 * 2 * 104 + 34 * 2];
    for row in [1, 33] {
        expected[2 * row + 1] = 1 << 1;
    }
    for (bitmap, column) in [34, 33, 32].into_iter().enumerate() {
        for block in [0, 1] {
            expected[68 + (2 * bitmap + block) * 104 + 32 + column] = 1 << 1;
        }
    }
    // The holes that are shown.
    let holes = 34 * 2 + 3 * 2 * 104;
    expected[holes + 2..holes + 6].copy_from_slice(&[1 << 31, 0xff & !(1 << 1), 1 << 31, 0xff]);
    assert_eq!(words, &expected);
}
