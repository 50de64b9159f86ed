//! The weighted median of a map.

use hsad::{
    dense::Median,
    disparity::{DisparityMap, NONE},
    gpu::Windows,
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
            let (luma, disparities) = (picture((width, height), 91), map(width, height, 92, 40));
            for windows in Windows::ALL {
                let (luma, disparities) = (luma.clone(), disparities.clone());
                let trial = MedianTrial { luma, disparities, median, windows };
                assert_twin(&format!("{width}x{height} {median:?} {windows:?}"), &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    // Pixel 1 is as dark as its left neighbour, and the three bright pixels to its right have no weight.
    let luma = Plane::new((5, 1), vec![10, 10, 200, 200, 200]).unwrap();
    let map = Plane::new((5, 1), vec![100, 900, 500, 500, NONE]).unwrap();
    let filtered = |halving_bits, windows| {
        let median = Median { radius: 2, halving_bits };
        let left = leaves(&MedianTrial { luma: luma.clone(), disparities: map.clone(), median, windows });
        let [Values::I32(filtered)] = &left[..] else { panic!("a disparity a pixel") };
        filtered.clone()
    };
    for windows in Windows::ALL {
        assert_eq!(filtered(3, windows)[..2], [100, 100], "{windows:?}");
        // With equal weights: the second of 100 500 500 900.
        assert_eq!(filtered(31, windows)[1], 500, "{windows:?}");
        assert_eq!(filtered(31, windows)[4], NONE, "{windows:?}");
    }
}
