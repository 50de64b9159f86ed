//! Removal of what does not show the scene.

use hsad::{
    dense::{Dense, View},
    disparity::{NONE, SCALE},
    image::{Luma, Plane, Size},
    internals::dense::Loss,
    luma::pack,
    verify::trials::UnseenTrial,
};

use crate::common::*;

#[test]
fn equals_the_twin() {
    for size in SIZES {
        for (view, loss) in View::ALL.into_iter().flat_map(|view| Loss::ALL.map(|loss| (view, loss))) {
            let disparity =
                picture(size, 61).map(|&value| if value < 50 { NONE } else { i32::from(value) * 37 - 3000 });
            let dense = Dense { confidence: picture(size, 62), disparity };
            let tall = Size::new(size.width, size.height + 3);
            let masks = [63, 64].map(|seed| picture(tall, seed).map(|&value| if value < 99 { 0 } else { value }));
            assert_twin(
                &format!("{size}, {view:?}, {loss:?}"),
                &UnseenTrial { dense, view, masks, first_row: 3, loss },
            );
        }
    }
}

#[test]
fn by_hand() {
    let (none, two) = (NONE, 2 * SCALE);
    let dense = Dense {
        disparity: Plane::new((6, 1), vec![two, none, 0, SCALE, SCALE + 127, SCALE + 128]).unwrap(),
        confidence: Plane::new((6, 1), vec![9, 0, 8, 7, 6, 5]).unwrap(),
    };
    let hides = |places: &[u32]| Luma::from_fn((6, 2), |x, y| if y == 1 && places.contains(&x) { 0 } else { 255 });
    let left = |own: &[u32], other: &[u32], loss| {
        let masks = [hides(own), hides(other)];
        leaves(&UnseenTrial { dense: dense.clone(), view: View::Left, masks, first_row: 1, loss })
    };
    let bytes = |confidences: [u8; 6]| pack(&Plane::new((6, 1), confidences.to_vec()).unwrap()).into();
    // Partners: beyond the left edge, where the mask goes on; none; and columns 2, 2, 3 and 3.
    assert_eq!(
        left(&[2], &[0, 3], Loss::Disparity),
        [vec![none, none, none, SCALE, none, none].into(), bytes([0, 0, 0, 7, 0, 0])]
    );
    assert_eq!(
        left(&[5], &[2], Loss::Confidence),
        [vec![two, none, 0, SCALE, SCALE + 127, none].into(), bytes([9, 0, 0, 0, 6, 0])]
    );
    assert_eq!(
        left(&[0], &[2, 3], Loss::Nothing),
        [vec![none, none, 0, SCALE, SCALE + 127, SCALE + 128].into(), bytes([0, 0, 8, 7, 6, 5])]
    );
}
