//! Bitmaps of the pixels that have a disparity.

use hsad::{
    disparity::NONE,
    image::{Plane, Size},
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
            assert_twin(&format!("{width}x{height}, {holes}"), &BitmapTrial { disparities });
        }
    }
}

#[test]
fn by_hand() {
    // 40x34 pixels, and a disparity in column 33 of rows 1 and 33.
    let disparities = Plane::from_fn((40, 34), |x, y| if x == 33 && y % 32 == 1 { 0 } else { NONE });
    let found = leaves(&BitmapTrial { disparities });
    let [Values::U32(words)] = &found[..] else { panic!("the words of the bitmaps") };
    // Rows of two words: bit 1 of the second word. Then for shears of -1, 0 and 1 two blocks of 32 + 40 + 32 columns: bit 1 of
    // the word whose diagonal passes column 33 in the second row of the block.
    let mut expected = vec![0; 34 * 2 + 3 * 2 * 104];
    for row in [1, 33] {
        expected[2 * row + 1] = 1 << 1;
    }
    for (bitmap, column) in [34, 33, 32].into_iter().enumerate() {
        for block in [0, 1] {
            expected[68 + (2 * bitmap + block) * 104 + 32 + column] = 1 << 1;
        }
    }
    assert_eq!(words, &expected);
}
