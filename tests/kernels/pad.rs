//! Padding.

use hsad::{
    dense::{Brightness, Pad, PadParams},
    reference::padded,
};

use crate::common::*;

fn on_device(width: u32, height: u32, seed: u32, params: PadParams) -> Vec<u32> {
    let luma = upload_luma(&picture(width, height, seed));
    let out = upload(&vec![0_u32; (params.offset + params.rows * params.stride) as usize]);
    poison(&out);
    let pad = Pad::new(&gpu().device).prepare(&gpu().device, params, &luma, &out);
    run(|encoder| pad.record(encoder));
    download(&out)
}

#[test]
fn by_hand() {
    // Of the row 10 20 30 the columns -4 to 7, twice, each pixel half as bright and one more.
    let brightness = Brightness { gain: 128, offset: 256 };
    let luma = upload(&[0x001e_140a_u32]);
    let params =
        PadParams { width: 3, height: 1, first_word: -1, first_row: -1, rows: 2, stride: 3, offset: 1, brightness };
    let out = upload(&[0_u32; 7]);
    poison(&out);
    let pad = Pad::new(&gpu().device).prepare(&gpu().device, params, &luma, &out);
    run(|encoder| pad.record(encoder));
    let row = [0x0606_0606, 0x1010_0b06, 0x1010_1010];
    assert_eq!(download::<u32>(&out), [u32::MAX, row[0], row[1], row[2], row[0], row[1], row[2]]);
}

#[test]
fn the_twin_pads_the_same() {
    for (width, height) in SIZES {
        for first_word in [-33, -9, -1, 0, 1, 4] {
            let params = PadParams {
                width,
                height,
                first_word,
                first_row: -3,
                rows: height + 7,
                stride: width.div_ceil(4) + 12,
                offset: 0,
                brightness: Brightness { gain: 300, offset: -9000 },
            };
            let what = format!("{width}x{height} from word {first_word}");
            assert_same(&what, &on_device(width, height, 5, params), &padded(&picture(width, height, 5), &params));
        }
    }
}
