use hsad::{image::Luma, luma::RgbaToLuma};

use crate::common::{SIZES, assert_same, download, gpu, poison, run, upload};

fn packed(width: u32, height: u32, pixels: &[[u8; 4]]) -> Vec<u32> {
    let stage = RgbaToLuma::new(&gpu().device, &upload(pixels), width, height).unwrap();
    poison(stage.luma());
    run(|encoder| stage.record(encoder));
    download(stage.luma())
}

#[test]
fn primaries_weigh_77_150_29() {
    // (77 * 255 + 128) >> 8 = 77, (150 * 255 + 128) >> 8 = 149, (29 * 255 + 128) >> 8 = 29.
    let pixels = [[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 255, 9], [255, 255, 255, 9], [100, 100, 100, 0]];
    // A row of five: the fifth starts a second word, whose other bytes are 0.
    assert_eq!(packed(5, 1, &pixels), [0xFF_1D_95_4D, 100]);
}

#[test]
fn rows_start_new_words() {
    assert_eq!(packed(1, 3, &[[1; 4], [2; 4], [3; 4]]), [1, 2, 3]);
}

#[test]
fn grey_stays_grey_at_every_size() {
    for (width, height) in SIZES {
        let luma = Luma::from_fn(width, height, |x, y| (x * 7 + y * 13) as u8);
        let pixels: Vec<_> = luma.data().iter().map(|&grey| [grey, grey, grey, 255]).collect();
        assert_same(&format!("{width}x{height}"), &packed(width, height, &pixels), &hsad::luma::pack(&luma));
    }
}
