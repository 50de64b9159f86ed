//! Selection of disparities by the summed costs of all paths.

use hsad::{
    dense::{Interpolation, Penalties},
    disparity::{DisparityRange, SCALE},
    image::{Plane, Size},
    internals::dense::Direction,
    verify::trials::SelectTrial,
};

use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };
const BACK: Direction = Direction { dx: -1, dy: 0 };

#[test]
fn the_twin_selects_the_same() {
    for Size { width, height } in SIZES {
        for (count, stored, uniqueness) in [(1_u32, 3, 0), (2, 1, 0), (17, 3, 10), (40, 7, 1)] {
            for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
                let volume = |seed| picture((width * count.next_multiple_of(16), height), seed).into_data();
                let trial = SelectTrial {
                    reference: picture((width, height), 99).map(|&value| value.into()),
                    costs: volume(55).iter().map(|&cost| cost / 2).collect(),
                    stored: (0..stored).map(volume).collect(),
                    range: DisparityRange::new(-3, count).unwrap(),
                    last: BACK,
                    penalties: PENALTIES,
                    interpolation,
                    uniqueness,
                };
                let what = format!("{width}x{height}, {count} disparities, {stored} paths and one, {interpolation:?}");
                assert_twin(&what, &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    // Sums 60 20 30 80: the second disparity wins, its rival is the last. The cost to its left is 40 more, to its right
    // 10 more: the parabola's vertex lies (40 - 10) / 2(40 + 10) = 0.3 px to the right.
    let trial = SelectTrial {
        // The path costs of the first pixel of a line are its matching costs.
        reference: Plane::filled((1, 1), 0),
        costs: [&[10, 5, 20, 40], &[0; 12][..]].concat(),
        stored: vec![[&[50, 15, 10, 40], &[0; 12][..]].concat()],
        range: DisparityRange::new(0, 4).unwrap(),
        last: BACK,
        penalties: PENALTIES,
        interpolation: Interpolation::Parabola,
        uniqueness: 0,
    };
    let (confidence, key) = (1 + 254 * 60 / 80_u32, 20_u32 << 16 | 1);
    assert_eq!(leaves(&trial), [vec![SCALE + 77].into(), vec![confidence].into(), vec![key].into()]);
}
