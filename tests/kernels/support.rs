//! Disparities that their neighbours share.

use hsad::{
    dense::{Dense, Support},
    disparity::{DisparityMap, NONE},
    image::Plane,
    luma::{pack, unpack},
    reference::supported,
};

use crate::common::*;

fn on_device(dense: &Dense, least: u32) -> Dense {
    let device = &gpu().device;
    let (width, height) = dense.disparity.size();
    let pixels = (width * height) as usize;
    let confidence = pack(&dense.confidence).into_iter().map(u32::cast_signed);
    let matches: Vec<i32> = dense.disparity.data().iter().copied().chain(confidence).collect();
    let (from, to) = (upload(&matches), upload(&matches));
    let kernel = Support::new(device, least).prepare(device, (width, height), width * height, &from, &to);
    poison(&to);
    run(|encoder| kernel.record(encoder));
    let both = download::<i32>(&to);
    Dense {
        disparity: Plane::new(width, height, both[..pixels].to_vec()).unwrap(),
        confidence: unpack(width, height, bytemuck::cast_slice(&both[pixels..])),
    }
}

/// A map with holes, whose disparities come in three groups.
fn map(width: u32, height: u32, seed: u32) -> DisparityMap {
    picture(width, height, seed).map(|&value| match value {
        0..60 => NONE,
        _ => i32::from(value % 3) * 400 - 300 + i32::from(value),
    })
}

#[test]
fn the_twin_keeps_the_same() {
    for (width, height) in SIZES {
        for least in [0, 1, 9, 49] {
            let disparity = map(width, height, 81);
            let dense = Dense { confidence: disparity.map(|&d| u8::from(d != NONE) * (d % 200) as u8), disparity };
            let (actual, expected) = (on_device(&dense, least), supported(&dense, least));
            let what = format!("{width}x{height}, {least}");
            assert_same(&what, actual.disparity.data(), expected.disparity.data());
            assert_same(&what, actual.confidence.data(), expected.confidence.data());
        }
    }
}

#[test]
fn by_hand() {
    // Three that differ by a pixel each from the next: only the middle one has two that share it.
    let disparity = Plane::new(4, 1, vec![0, 256, 512, NONE]).unwrap();
    let dense = Dense { confidence: Plane::new(4, 1, vec![5, 200, 7, 0]).unwrap(), disparity };
    let kept = on_device(&dense, 3);
    assert_eq!(kept.disparity.data(), [NONE, 256, NONE, NONE]);
    assert_eq!(kept.confidence.data(), [0, 1 + 5 * 2 + 3, 0, 0]);
}
