//! Packed luma to RGBA8.

use hsad::{
    image::{Luma, Size},
    verify::trials::RgbaTrial,
};

use crate::common::{SIZES, assert_twin, leaves, picture};

#[test]
fn the_twin_converts_the_same() {
    for Size { width, height } in SIZES {
        for first_row in [0, height / 2, height - 1] {
            let luma = picture((width, height), 121);
            assert_twin(&format!("{width}x{height} from {first_row} on"), &RgbaTrial { luma, first_row });
        }
    }
}

#[test]
fn by_hand() {
    let luma = Luma::new((5, 2), vec![1, 2, 3, 4, 5, 6, 7, 8, 9, 255]).unwrap();
    let pixels = leaves(&RgbaTrial { luma, first_row: 1 });
    assert_eq!(pixels, [vec![0xff06_0606_u32, 0xff07_0707, 0xff08_0808, 0xff09_0909, 0xffff_ffff].into()]);
}
