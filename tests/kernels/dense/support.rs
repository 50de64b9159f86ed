//! Support by neighbouring disparities.

use hsad::{
    dense::Dense,
    disparity::{DisparityMap, NONE},
    image::{Plane, Size},
    luma::pack,
    verify::trials::SupportTrial,
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
        for least in [0, 1, 9, 49] {
            let disparity = map(width, height, 81);
            let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * (d % 200) as u8), disparity };
            let residuals = picture((width, height), 82).map(|&value| value % 32);
            assert_twin(&format!("{width}x{height}, {least}"), &SupportTrial { dense, residuals, least });
        }
    }
}

#[test]
fn by_hand() {
    // Three disparities, 1 px apart each: only the middle one has two others within 1 px.
    let disparity = Plane::new((4, 1), vec![0, 256, 512, NONE]).unwrap();
    let dense = Dense { confidence: Plane::new((4, 1), vec![5, 200, 7, 0]).unwrap(), disparity };
    // The sum of residuals in the row lowers the confidence by an eighth, but not below 1.
    for (residual, lowered) in [(0, 0), (7, 3), (31, 13)] {
        let confidences = pack(&Plane::new((4, 1), vec![0, 1 + 5 * 2 + 3 - lowered, 0, 0]).unwrap());
        let residuals = Plane::new((4, 1), vec![residual, residual, residual, residual + 3]).unwrap();
        let kept = leaves(&SupportTrial { dense: dense.clone(), residuals, least: 3 });
        assert_eq!(kept, [vec![NONE, 256, NONE, NONE].into(), confidences.into()]);
    }
}
