//! Soft ranks.

use hsad::{
    image::{Luma, Size},
    internals::dense::PadParams,
    verify::trials::SoftRankTrial,
};

use crate::common::*;

#[test]
fn by_hand() {
    // A pixel of 100 in a picture of 90, and one of 101 beside it, which differs less from it than the limit of 3.
    let luma = |x: u32, y: u32| match (x, y) {
        (6, 2) => 100,
        (10, 2) => 101,
        _ => 90,
    };
    let picture = Luma::from_fn((12, 5), luma);
    let params = PadParams { width: 12, height: 5, first_word: 0, first_row: 0, rows: 5, stride: 3, offset: 0 };
    let plane = leaves(&SoftRankTrial { picture, params });
    let ranks = |row: [[u8; 4]; 3]| row.map(u32::from_le_bytes);
    let expected: Vec<u32> = [
        // Two rows above: diagonal neighbours weigh 1, the neighbour below 2. Column 8 is diagonal to both.
        ranks([[128, 128, 128, 128], [131, 128, 134, 128], [134, 128, 134, 128]]),
        ranks([[128; 4]; 3]),
        // Columns 2, 3 and 9 see the pixel of 100 three or four columns away, column 7 that of 101. Of the weights of 12, 11
        // count 3 darker for either pixel, and one counts the other pixel, which differs by 1.
        ranks([[128, 128, 131, 131], [128, 128, 128 - 33 + 1, 131], [128, 131, 128 - 33 - 1, 128]]),
        ranks([[128; 4]; 3]),
        ranks([[128, 128, 128, 128], [131, 128, 134, 128], [134, 128, 134, 128]]),
    ]
    .concat();
    assert_eq!(plane, [expected.into()]);
}

#[test]
fn brightness_does_not_matter() {
    let picture = picture((40, 30), 3).map(|&luma| luma / 2);
    let params = PadParams { width: 40, height: 30, first_word: -2, first_row: -3, rows: 36, stride: 15, offset: 0 };
    let brighter = picture.map(|&luma| luma + 100);
    let leaves = [picture, brighter].map(|picture| leaves(&SoftRankTrial { picture, params }));
    assert_eq!(leaves[0], leaves[1]);
}

#[test]
fn the_twin_ranks_the_same() {
    for Size { width, height } in SIZES {
        for first_word in [-33, -9, -1, 0, 1, 4] {
            let params = PadParams {
                width,
                height,
                first_word,
                first_row: -3,
                rows: height + 7,
                stride: width.div_ceil(4) + 12,
                offset: 0,
            };
            let trial = SoftRankTrial { picture: picture((width, height), 5).map(|&luma| luma / 16), params };
            assert_twin(&format!("{width}x{height} from word {first_word}"), &trial);
        }
    }
}
