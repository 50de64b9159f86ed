//! Half the size.

use hsad::{dense::Halve, image::reduced, luma::pack};

use crate::common::*;

#[test]
fn the_twin_halves_the_same() {
    for (width, height) in SIZES {
        let luma = picture(width, height, 71);
        let expected = pack(&reduced(&luma, 2));
        let out = upload(&vec![0_u32; expected.len()]);
        poison(&out);
        let halve = Halve::new(&gpu().device).prepare(&gpu().device, (width, height), &upload_luma(&luma), &out);
        run(|encoder| halve.record(encoder));
        assert_same(&format!("{width}x{height}"), &download::<u32>(&out), &expected);
    }
}

#[test]
fn by_hand() {
    // 1 2 3
    // 5 6 8
    // 9 9 7: means of four, of two, and one alone, halves up.
    let luma = upload(&[0x0003_0201_u32, 0x0008_0605, 0x0007_0909]);
    let out = upload(&[0_u32; 2]);
    poison(&out);
    let halve = Halve::new(&gpu().device).prepare(&gpu().device, (3, 3), &luma, &out);
    run(|encoder| halve.record(encoder));
    assert_eq!(download::<u32>(&out), [0x0604, 0x0709]);
}
