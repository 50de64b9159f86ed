use hsad::{luma::RgbaToLuma, reference};

use crate::common::{SIZES, assert_same, download, gpu, photographs, picture, poison, run, upload};

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

fn assert_equals_the_twin(name: &str, (width, height): (u32, u32), pixels: &[[u8; 4]]) {
    let luma = reference::luma::from_rgba(width, height, pixels.as_flattened()).unwrap();
    assert_same(name, &packed(width, height, pixels), &hsad::luma::pack(&luma));
}

#[test]
fn equals_the_twin_at_every_size() {
    for (width, height) in SIZES {
        let [red, green, blue] = [1, 2, 3].map(|seed| picture(width, height, seed));
        let pixels: Vec<_> =
            (0..red.data().len()).map(|i| [red.data()[i], green.data()[i], blue.data()[i], i as u8]).collect();
        assert_equals_the_twin(&format!("{width}x{height}"), (width, height), &pixels);
    }
}

#[test]
fn equals_the_twin_on_photographs() {
    for (name, picture) in photographs() {
        assert_equals_the_twin(&name, picture.size(), picture.data());
    }
}
