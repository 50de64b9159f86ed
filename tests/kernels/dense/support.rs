//! Support by neighbouring disparities.

use hsad::{
    dense::Dense,
    disparity::{DisparityMap, NONE},
    gpu::Windows,
    image::{Plane, Size},
    luma::{pack, unpack},
    verify::{Values, trials::SupportTrial},
};

use crate::common::*;

/// A map with holes, whose disparities come in three groups.
fn map(width: u32, height: u32, seed: u32) -> DisparityMap {
    picture((width, height), seed).map(|&value| match value {
        0..60 => NONE,
        _ => i32::from(value % 3) * 400 - 300 + i32::from(value),
    })
}

#[test]
fn the_twin_keeps_the_same() {
    for Size { width, height } in SIZES {
        for (least, majority) in [(0, false), (1, true), (9, false), (9, true), (49, false)] {
            let disparity = map(width, height, 81);
            let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * (d % 200) as u8), disparity };
            let residuals = picture((width, height), 82).map(|&value| value % 32);
            for windows in Windows::ALL {
                let (dense, residuals) = (dense.clone(), residuals.clone());
                let trial = SupportTrial { dense, residuals, least, majority, windows };
                assert_twin(&format!("{width}x{height}, {least} {majority} {windows:?}"), &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    // Three disparities, 1 px apart each: only the middle one has two others within 1 px. Confidences are at least 16.
    let disparity = Plane::new((4, 1), vec![0, 256, 512, NONE]).unwrap();
    let dense = Dense { confidence: Plane::new((4, 1), vec![5, 200, 7, 0]).unwrap(), disparity };
    // The sum of residuals in the row lowers the confidence by an eighth, but not below 1.
    for residual in [0, 31] {
        let confidences = pack(&Plane::new((4, 1), vec![0, 16, 0, 0]).unwrap());
        let residuals = Plane::new((4, 1), vec![residual, residual, residual, residual + 3]).unwrap();
        for windows in Windows::ALL {
            let (dense, residuals) = (dense.clone(), residuals.clone());
            let kept = leaves(&SupportTrial { dense, residuals, least: 3, majority: false, windows });
            assert_eq!(kept, [vec![NONE, 256, NONE, NONE].into(), confidences.clone().into()], "{windows:?}");
        }
    }
}

#[test]
fn residuals_lower_the_confidence() {
    // Of 49 pixels of one disparity: 1 + 5 * 48, and 3 for the confidence so far, less an eighth of 25 residuals.
    let dense = Dense { disparity: Plane::filled((7, 7), 100), confidence: Plane::filled((7, 7), 200) };
    for (residual, expected) in [(0, 244), (7, 244 - 21), (31, 244 - 96)] {
        for windows in Windows::ALL {
            let residuals = Plane::filled((7, 7), residual);
            let kept = leaves(&SupportTrial { dense: dense.clone(), residuals, least: 49, majority: true, windows });
            let [_, Values::U32(confidences)] = &kept[..] else { panic!("a map") };
            assert_eq!(unpack((7, 7), confidences).get(3, 3), expected, "{windows:?}");
        }
    }
}

#[test]
fn a_majority_is_half_of_the_window_within_the_picture() {
    // In the corner the window has 16 pixels, and 8 of them have a disparity.
    let half = |gone: Option<(u32, u32)>, step: i32, windows| {
        let value = |x: u32| 512 + step * (x as i32 % 2);
        let disparity = Plane::from_fn((4, 4), |x, y| if y < 2 && Some((x, y)) != gone { value(x) } else { NONE });
        let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE)), disparity };
        let trial = SupportTrial { dense, residuals: Plane::filled((4, 4), 0), least: 1, majority: true, windows };
        let [Values::I32(kept), _] = &leaves(&trial)[..] else { panic!("a map") };
        kept[0]
    };
    // Disparities up to 2 px larger count for a majority, and all smaller ones.
    for windows in Windows::ALL {
        assert_eq!((half(None, 512, windows), half(Some((3, 1)), 512, windows)), (512, NONE));
        assert_eq!((half(None, 513, windows), half(None, -9000, windows)), (NONE, 512));
    }
}
