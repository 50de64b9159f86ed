//! Agreement of neighbouring disparities.

use hsad::{
    dense::Dense,
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
    luma::pack,
    verify::trials::AgreementTrial,
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
        for least in [0, 1, 4, 6, 9] {
            let disparity = map(width, height, 81);
            let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * (d % 200) as u8), disparity };
            assert_twin(&format!("{width}x{height}, {least}"), &AgreementTrial { dense, least });
        }
    }
}

#[test]
fn by_hand() {
    // Columns 0, 3 and 6 see each other, of a single row: 2 px apart they agree, farther apart not.
    let disparity = |third: i32| Plane::new((7, 1), vec![0, 9, NONE, 2 * SCALE, 9, NONE, third]).unwrap();
    let confidence = Plane::new((7, 1), vec![5, 6, 0, 7, 8, 0, 9]).unwrap();
    let kept = |third, least| {
        let dense = Dense { disparity: disparity(third), confidence: confidence.clone() };
        leaves(&AgreementTrial { dense, least })
    };
    let (none, two) = (NONE, 2 * SCALE);
    let confidences = |bytes: [u8; 7]| pack(&Plane::new((7, 1), bytes.to_vec()).unwrap());
    // The middle one agrees with both others and itself, columns 1 and 4 with each other.
    assert_eq!(
        kept(4 * SCALE, 3),
        [vec![none, none, none, two, none, none, none].into(), confidences([0, 0, 0, 7, 0, 0, 0]).into()]
    );
    assert_eq!(
        kept(4 * SCALE + 1, 2),
        [vec![0, 9, none, two, 9, none, none].into(), confidences([5, 6, 0, 7, 8, 0, 0]).into()]
    );
    assert_eq!(
        kept(4 * SCALE + 1, 1),
        [vec![0, 9, none, two, 9, none, 4 * SCALE + 1].into(), confidences([5, 6, 0, 7, 8, 0, 9]).into()]
    );
}
