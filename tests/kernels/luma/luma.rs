use hsad::{
    image::{Plane, Size},
    verify::trials::LumaTrial,
};

use crate::common::{SIZES, assert_twin, leaves, photographs, picture};

fn packed(width: u32, height: u32, pixels: &[[u8; 4]]) -> LumaTrial {
    LumaTrial(Plane::new((width, height), pixels.to_vec()).unwrap())
}

#[test]
fn primaries_weigh_77_150_29() {
    // (77 * 255 + 128) >> 8 = 77, (150 * 255 + 128) >> 8 = 149, (29 * 255 + 128) >> 8 = 29.
    let pixels = [[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 255, 9], [255, 255, 255, 9], [100, 100, 100, 0]];
    // A row of five pixels: the fifth starts a second word, whose other bytes are 0.
    assert_eq!(leaves(&packed(5, 1, &pixels)), [vec![0xFF_1D_95_4D_u32, 100].into()]);
}

#[test]
fn rows_start_new_words() {
    assert_eq!(leaves(&packed(1, 3, &[[1; 4], [2; 4], [3; 4]])), [vec![1_u32, 2, 3].into()]);
}

#[test]
fn equals_the_twin_at_every_size() {
    for Size { width, height } in SIZES {
        let [red, green, blue] = [1, 2, 3].map(|seed| picture((width, height), seed));
        let pixel = |x, y| [red.get(x, y), green.get(x, y), blue.get(x, y), (x + y) as u8];
        assert_twin(&format!("{width}x{height}"), &LumaTrial(Plane::from_fn((width, height), pixel)));
    }
}

#[test]
fn equals_the_twin_on_photographs() {
    for (name, picture) in photographs() {
        assert_twin(&name, &LumaTrial(picture));
    }
}
