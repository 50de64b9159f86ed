//! Maps taken back to another picture.

use hsad::{
    dense::Dense,
    disparity::NONE,
    glam::DVec2,
    image::{Plane, Size},
    luma::pack,
    rectify::WarpMap,
    verify::trials::MapBackTrial,
};

use crate::common::*;

#[test]
fn by_hand() {
    let dense = Dense {
        disparity: Plane::new((4, 1), vec![100, 200, 1000, NONE]).unwrap(),
        confidence: Plane::new((4, 1), vec![10, 20, 30, 40]).unwrap(),
    };
    let back = WarpMap::new((5, 1), (4, 1), |p| p - DVec2::new(0.75, 0.0)).unwrap();
    // At -0.75 nothing is shown; 0.25 lies between 100 and 200, 1.25 at an edge, 2.25 beside a hole, 3.25 in it.
    let confidences = pack(&Plane::new((5, 1), vec![0, 10, 20, 30, 0]).unwrap());
    assert_eq!(leaves(&MapBackTrial { dense, back }), [vec![NONE, 125, 200, 1000, NONE].into(), confidences.into()]);
}

/// Weights of all four pixels, and halves are rounded up.
#[test]
fn between_four_pixels() {
    let dense = |values: [i32; 4]| Dense {
        disparity: Plane::new((2, 2), values.to_vec()).unwrap(),
        confidence: Plane::filled((2, 2), 9),
    };
    let at = |x: f64, y: f64| WarpMap::new((1, 1), (2, 2), move |_| DVec2::new(x, y)).unwrap();
    let found = |values, x, y| leaves(&MapBackTrial { dense: dense(values), back: at(x, y) });
    let expected = |value: i32| [vec![value].into(), vec![9_u32].into()];
    // 3/16 * 0 + 1/16 * 256 + 9/16 * -16 + 3/16 * 96
    assert_eq!(found([0, 240, -16, 96], 0.25, 0.75), expected(24));
    assert_eq!(found([-3, -2, -3, -2], 0.5, 0.0), expected(-2));
    assert_eq!(found([0, 256, 256, 256], 0.5, 0.5), expected(192));
    // One unit more than a pixel apart from the first, but not from the others: all count for the others.
    assert_eq!(found([0, 256, 256, 257], 0.25, 0.25), expected(112));
    // The surface that weighs most, and not the nearest pixel; unknown pixels weigh nothing.
    assert_eq!(found([0, 1000, 1000, 1000], 0.375, 0.375), expected(1000));
    assert_eq!(found([NONE, 7, NONE, NONE], 0.125, 0.125), expected(7));
    // Of two surfaces of one weight the first.
    assert_eq!(found([9, 500, 9, 500], 0.5, 0.5), expected(9));
    // The extremes of one surface.
    assert_eq!(found([0, 256, 256, 0], 1.0 - 1.0 / 2048.0, 1.0 - 1.0 / 2048.0), expected(0));
}

#[test]
fn equals_the_twin() {
    for (size, source_size) in SIZES.into_iter().flat_map(|size| SIZES.map(|source_size| (size, source_size))) {
        let Size { width, height } = source_size;
        let surface = picture(source_size, 71);
        let disparity =
            picture(source_size, 72).map(|&value| if value < 20 { NONE } else { i32::from(value % 4) * 90 - 300 });
        let dense = Dense { confidence: Plane::from_fn((width, height), |x, y| surface.get(x, y)), disparity };
        let of = |p: DVec2| DVec2::new(0.9 * p.x - 0.2 * p.y + 1.3, 0.2 * p.x + 1.1 * p.y - 5.7);
        let back = WarpMap::within(0.01, size, source_size, of).unwrap();
        assert_twin(&format!("{size} from {source_size}"), &MapBackTrial { dense, back });
    }
}
