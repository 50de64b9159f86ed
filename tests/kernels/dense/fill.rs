//! Filling of holes along rows.

use hsad::{
    disparity::{DisparityRange, NONE},
    image::{Plane, Size},
    verify::{Values, trials::FillTrial},
};

use crate::common::*;

#[test]
fn the_twin_fills_the_same() {
    for Size { width, height } in SIZES {
        for (holes, slope) in [(0, 0), (5, 30), (200, -70), (255, 9)] {
            let (coarse, fine) = (picture((width.div_ceil(40), height), 101), picture((width, height), 102));
            // Slanted surfaces with noise, of all lengths.
            let disparities = Plane::from_fn((width, height), |x, y| match fine.get(x, y) {
                value if value < holes && (holes > 250 || x % 3 == 0) => NONE,
                value => i32::from(coarse.get(x / 40, y)) * 40 - 3000 + slope * x as i32 + i32::from(value % 64),
            });
            let range = DisparityRange::new(-12, 41).unwrap();
            assert_twin(&format!("{width}x{height}, {holes} {slope}"), &FillTrial { disparities, range });
        }
    }
}

#[test]
fn by_hand() {
    let range = DisparityRange::new(0, 20).unwrap();
    let map = Plane::new((5, 1), vec![NONE, 512, NONE, 1024, NONE]).unwrap();
    assert_eq!(leaves(&FillTrial { disparities: map, range }), [vec![512, 512, 512, 1024, 1024].into()]);
    // A slope of 16/256 px per pixel is continued beyond the end of its surface.
    let slanted = Plane::from_fn((40, 1), |x, _| if x < 30 { 256 + 16 * x as i32 } else { NONE });
    let filled = leaves(&FillTrial { disparities: slanted, range });
    let [Values::I32(filled)] = &filled[..] else { panic!("a disparity a pixel") };
    assert_eq!(filled[35], 256 + 16 * 35);
}
