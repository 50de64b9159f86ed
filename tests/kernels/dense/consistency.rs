//! Left-right consistency.

use hsad::{
    dense::{Dense, View},
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
    luma::pack,
    verify::trials::ConsistencyTrial,
};

use crate::common::*;

/// Disparities of all kinds: none, fractions, negative, out of the picture.
fn disparities(width: u32, height: u32, seed: u32) -> DisparityMap {
    let (coarse, fine) = (picture((width, height), seed), picture((width, height), seed + 1));
    Plane::from_fn((width, height), |x, y| match coarse.get(x, y) {
        0..50 => NONE,
        value => (i32::from(value) - 120) * 8 + i32::from(fine.get(x, y)),
    })
}

#[test]
fn the_twin_checks_the_same() {
    for Size { width, height } in SIZES {
        for view in [View::Left, View::Right] {
            for max_difference in [0, 100, 256, 65536] {
                let disparity = disparities(width, height, 3);
                let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * 77), disparity };
                let others = disparities(width, height, 9);
                let whole = |&d: &i32| if d == NONE { NONE } else { d.div_euclid(SCALE) * SCALE };
                let what = format!("{width}x{height} {view:?} {max_difference}");
                let claimed = others.map(whole);
                let trial = ConsistencyTrial { dense, view, others, claims_from: None, max_difference };
                assert_twin(&what, &trial);
                assert_twin(&what, &ConsistencyTrial { others: claimed, claims_from: Some(-9), ..trial });
            }
        }
    }
}

#[test]
fn by_hand() {
    let plane = |values: &[i32]| Plane::new((values.len() as u32, 1), values.to_vec()).unwrap();
    let disparity = plane(&[0, 256, 300, 2 * 256, NONE, 6 * 256]);
    let dense = Dense { confidence: disparity.map(|&d| if d == NONE { 0 } else { 9 }), disparity };
    let others = plane(&[40, 260, NONE, 0, 0, 0]);
    let trial = ConsistencyTrial { dense, view: View::Left, others, claims_from: None, max_difference: 40 };
    let confidences = pack(&Plane::new((6, 1), vec![9, 0, 9, 0, 0, 0]).unwrap());
    assert_eq!(leaves(&trial), [vec![0, NONE, 300, NONE, NONE, NONE].into(), confidences.into()]);
}
