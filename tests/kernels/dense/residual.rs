//! The photometric residual.

use hsad::{
    dense::{Brightness, View},
    disparity::NONE,
    image::{Plane, Size},
    luma::pack,
    verify::trials::ResidualTrial,
};

use crate::common::*;

#[test]
fn the_twin_compares_the_same() {
    for Size { width, height } in SIZES {
        for reference in [View::Left, View::Right] {
            for (first_row, brightness) in
                [(0, Brightness::SAME), (height / 2, Brightness { gain: 300, offset: -2000 })]
            {
                let views = [picture((width, height), 91), picture((width, height), 92)];
                let disparities = picture((width, height - first_row), 93).map(|&value| match value {
                    0..50 => NONE,
                    _ => (i32::from(value) - 120) * 100,
                });
                let trial = ResidualTrial { views, brightness, reference, first_row, disparities };
                assert_twin(&format!("{width}x{height} {reference:?}"), &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    let luma = |levels: &[u8]| Plane::new((levels.len() as u32, 1), levels.to_vec()).unwrap();
    let views = [luma(&[10, 20, 30, 40, 200]), luma(&[10, 12, 99, 41, 90])];
    // Partners of pixels 0 to 4: 0; none; 2 - 1, since a half rounds up; 3 + 1; outside.
    let disparities = Plane::new((5, 1), vec![0, NONE, 128, -256, 5 * 256]).unwrap();
    let trial = ResidualTrial { views, brightness: Brightness::SAME, reference: View::Left, first_row: 0, disparities };
    assert_eq!(leaves(&trial), [pack(&luma(&[0, 0, 18, 31, 31])).into()]);
    // Twice the luma minus 10: 10, 14, 188, 72, 170.
    let brighter = ResidualTrial { brightness: Brightness { gain: 512, offset: -2560 }, ..trial.clone() };
    assert_eq!(leaves(&brighter), [pack(&luma(&[0, 0, 16, 31, 31])).into()]);
    // Partners on the other side: 0; none; 3; 2; outside.
    assert_eq!(leaves(&ResidualTrial { reference: View::Right, ..trial }), [pack(&luma(&[0, 0, 31, 11, 31])).into()]);
}
