//! Left-right consistency.

use hsad::{
    dense::{Consistency, Dense, Others, View},
    disparity::{DisparityMap, NONE},
    image::Plane,
    luma::{pack, unpack},
    reference::check_consistency,
};

use crate::common::*;

fn on_device(dense: &Dense, view: View, others: &DisparityMap, max_difference: u32) -> Dense {
    let device = &gpu().device;
    let (width, height) = dense.disparity.size();
    let others = upload(others.data());
    let pixels = (width * height) as usize;
    let confidence = pack(&dense.confidence).into_iter().map(u32::cast_signed);
    let both: Vec<i32> = dense.disparity.data().iter().copied().chain(confidence).collect();
    let matches = upload(&both);
    let size = (width, height);
    let check = Consistency::new(device, Others::Disparities).prepare(
        device,
        size,
        width * height,
        view,
        max_difference,
        &others,
        &matches,
    );
    run(|encoder| check.record(encoder));
    let both = download::<i32>(&matches);
    Dense {
        disparity: Plane::new(width, height, both[..pixels].to_vec()).unwrap(),
        confidence: unpack(width, height, bytemuck::cast_slice(&both[pixels..])),
    }
}

/// Disparities of all kinds: none, fractions, negative, out of the picture.
fn disparities(width: u32, height: u32, seed: u32) -> DisparityMap {
    let (coarse, fine) = (picture(width, height, seed), picture(width, height, seed + 1));
    Plane::from_fn(width, height, |x, y| match coarse.get(x, y) {
        0..50 => NONE,
        value => (i32::from(value) - 120) * 8 + i32::from(fine.get(x, y)),
    })
}

#[test]
fn the_twin_checks_the_same() {
    for (width, height) in SIZES {
        for view in [View::Left, View::Right] {
            for max_difference in [0, 100, 256, 65536] {
                let disparity = disparities(width, height, 3);
                let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * 77), disparity };
                let others = disparities(width, height, 9);
                let mut expected = dense.clone();
                check_consistency(&mut expected, view, &others, max_difference);
                let actual = on_device(&dense, view, &others, max_difference);
                let what = format!("{width}x{height} {view:?} {max_difference}");
                assert_same(&what, actual.disparity.data(), expected.disparity.data());
                assert_same(&what, actual.confidence.data(), expected.confidence.data());
            }
        }
    }
}

#[test]
fn by_hand() {
    let plane = |values: &[i32]| Plane::new(values.len() as u32, 1, values.to_vec()).unwrap();
    let disparity = plane(&[0, 256, 300, 2 * 256, NONE, 6 * 256]);
    let dense = Dense { confidence: disparity.map(|&d| if d == NONE { 0 } else { 9 }), disparity };
    let others = plane(&[40, 260, NONE, 0, 0, 0]);
    let checked = on_device(&dense, View::Left, &others, 40);
    assert_eq!(checked.disparity.data(), [0, NONE, 300, NONE, NONE, NONE]);
    assert_eq!(checked.confidence.data(), [9, 0, 9, 0, 0, 0]);
}
