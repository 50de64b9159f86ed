//! The weighted median of a map.

use hsad::{
    dense::Median,
    disparity::{DisparityMap, NONE},
    image::{Plane, Size},
    verify::{Values, trials::MedianTrial},
};

use crate::common::*;

fn map(width: u32, height: u32, seed: u32, holes: u8) -> DisparityMap {
    let (coarse, fine) = (picture((width, height), seed), picture((width, height), seed + 1));
    Plane::from_fn((width, height), |x, y| match coarse.get(x, y) {
        value if value < holes => NONE,
        value => (i32::from(value) - 100) * 97 + i32::from(fine.get(x, y)),
    })
}

#[test]
fn the_twin_filters_the_same() {
    for (radius, halving_bits) in [(1, 31), (2, 3), (2, 0), (4, 5)] {
        let median = Median { radius, halving_bits };
        for Size { width, height } in SIZES {
            let disparities = map(width, height, 92, 40);
            let trial = MedianTrial { luma: picture((width, height), 91), disparities, median };
            assert_twin(&format!("{width}x{height} {median:?}"), &trial);
        }
    }
}

#[test]
fn by_hand() {
    // Pixel 1 is as dark as its left neighbour, and the three bright pixels to its right have no weight.
    let luma = Plane::new((5, 1), vec![10, 10, 200, 200, 200]).unwrap();
    let map = Plane::new((5, 1), vec![100, 900, 500, 500, NONE]).unwrap();
    let filtered = |halving_bits| {
        let median = Median { radius: 2, halving_bits };
        let left = leaves(&MedianTrial { luma: luma.clone(), disparities: map.clone(), median });
        let [Values::I32(filtered)] = &left[..] else { panic!("a disparity a pixel") };
        filtered.clone()
    };
    assert_eq!(filtered(3)[..2], [100, 100]);
    // With equal weights: the second of 100 500 500 900.
    assert_eq!(filtered(31)[1], 500);
    assert_eq!(filtered(31)[4], NONE);
}
