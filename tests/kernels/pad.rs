//! Padding.

use hsad::{
    dense::{Pad, PadParams},
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
    // Of the row 10 20 30 the columns -2 to 5, twice; in the mirror it is 30 20 10.
    let luma = upload(&[0x001e_140a_u32]);
    let params =
        PadParams { width: 3, height: 1, first_column: -2, first_row: -1, rows: 2, stride: 2, offset: 1, mirrored: 0 };
    let show = |params| {
        let out = upload(&[0_u32; 5]);
        poison(&out);
        let pad = Pad::new(&gpu().device).prepare(&gpu().device, params, &luma, &out);
        run(|encoder| pad.record(encoder));
        download::<u32>(&out)
    };
    let row = [0x140a_0a0a, 0x1e1e_1e1e];
    assert_eq!(show(params), [u32::MAX, row[0], row[1], row[0], row[1]]);
    let row = [0x141e_1e1e, 0x0a0a_0a0a];
    assert_eq!(show(PadParams { mirrored: 1, ..params }), [u32::MAX, row[0], row[1], row[0], row[1]]);
}

#[test]
fn the_twin_pads_the_same() {
    for (width, height) in SIZES {
        for (first_column, mirrored) in [(-4, 0), (-37, 0), (3, 0), (-4, 1), (-131, 1), (5, 1)] {
            let params = PadParams {
                width,
                height,
                first_column,
                first_row: -3,
                rows: height + 7,
                stride: width.div_ceil(4) + 12,
                offset: 0,
                mirrored,
            };
            let what = format!("{width}x{height} from {first_column}, mirrored {mirrored}");
            assert_same(&what, &on_device(width, height, 5, params), &padded(&picture(width, height, 5), &params));
        }
    }
}
