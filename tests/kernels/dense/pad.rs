//! Padding.

use hsad::{
    dense::Brightness,
    image::{Luma, Size},
    internals::dense::PadParams,
    verify::trials::PadTrial,
};

use crate::common::*;

#[test]
fn by_hand() {
    // Columns -4 to 7 of the row 10 20 30, in two rows, with half the luma plus 1.
    let brightness = Brightness { gain: 128, offset: 256 };
    let picture = Luma::new((3, 1), vec![10, 20, 30]).unwrap();
    let params = PadParams { width: 3, height: 1, first_word: -1, first_row: -1, rows: 2, stride: 3, offset: 1 };
    let row = [0x0606_0606, 0x1010_0b06, 0x1010_1010];
    let expected = vec![u32::MAX, row[0], row[1], row[2], row[0], row[1], row[2]];
    assert_eq!(leaves(&PadTrial { picture, params, brightness }), [expected.into()]);
}

#[test]
fn the_twin_pads_the_same() {
    for Size { width, height } in SIZES {
        let brightness = Brightness { gain: 300, offset: -9000 };
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
            let trial = PadTrial { picture: picture((width, height), 5), params, brightness };
            assert_twin(&format!("{width}x{height} from word {first_word}"), &trial);
        }
    }
}
