//! The census transform.

use hsad::{
    dense::{Brightness, Census, Pad},
    image::Luma,
    reference,
};

use crate::common::*;

fn on_device(luma: &Luma) -> Vec<u32> {
    let device = &gpu().device;
    let size = luma.size();
    let padding = Census::padding(size, 0, size.1, Brightness::SAME);
    let padded = upload(&vec![0_u32; (padding.rows * padding.stride) as usize]);
    let census = upload(&vec![0_u32; luma.data().len()]);
    let dispatches = [
        Pad::new(device).prepare(device, padding, &upload_luma(luma), &padded),
        Census::new(device).prepare(device, size, &padded, &census),
    ];
    poison(&padded);
    poison(&census);
    run(|encoder| dispatches.iter().for_each(|dispatch| dispatch.record(encoder)));
    download(&census)
}

#[test]
fn the_twin_transforms_the_same() {
    for (width, height) in SIZES {
        let luma = picture(width, height, 61);
        assert_same(&format!("{width}x{height}"), &on_device(&luma), reference::census(&luma).data());
    }
}

#[test]
fn by_hand() {
    // One dark pixel in the middle of 5x5 others: it sees no darker one, and each of the others sees it
    // where it stands in their window.
    let luma = Luma::from_fn(5, 5, |x, y| if (x, y) == (2, 2) { 10 } else { 20 });
    let census = on_device(&luma);
    assert_eq!(census[12], 10);
    // Two to the right and two below of the first, so the last of its 24 bits; the first of the last one's.
    assert_eq!(census[0], 1 << 8 | 20);
    assert_eq!(census[24], 1 << 31 | 20);
}
