//! A path of semi-global matching.

use hsad::{
    dense::Penalties,
    image::{Plane, Size},
    internals::dense::Direction,
    verify::trials::PathTrial,
};

use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };

fn costs(width: u32, height: u32, count: u32) -> Vec<u8> {
    picture((width * count, height), 77).data().iter().map(|&value| value / 2).collect()
}

#[test]
fn the_twin_goes_the_same_way() {
    for Size { width, height } in SIZES {
        for direction in Direction::ALL {
            let reference = picture((width, height), 71).map(|&value| u32::from(value) | 0xabcd_ef00);
            let costs = costs(width, height, 48);
            let trial = PathTrial { reference, costs, direction, penalties: PENALTIES, band_rows: height };
            assert_twin(&format!("{width}x{height} {direction:?}"), &trial);
        }
    }
}

#[test]
fn bands_leave_no_trace() {
    for direction in Direction::ALL {
        for band_rows in [1, 7] {
            let reference = picture((37, 20), 72).map(|&value| value.into());
            let trial = PathTrial { reference, costs: costs(37, 20, 16), direction, penalties: PENALTIES, band_rows };
            assert_twin(&format!("{direction:?} in bands of {band_rows}"), &trial);
        }
    }
}

#[test]
fn by_hand() {
    // Two pixels of the same luma. From costs 5 9 30 90: no change, 5; no change, 9; P1, 9 + P1 = 25 before 30; a jump,
    // 5 + P2. Beyond them too: a jump from 200 each.
    let trial = PathTrial {
        reference: Plane::new((2, 1), vec![7, 7]).unwrap(),
        costs: [&[5, 9, 30, 200], &[200; 12][..], &[1, 2, 3, 4], &[0; 12][..]].concat(),
        direction: Direction { dx: 1, dy: 0 },
        penalties: PENALTIES,
        band_rows: 1,
    };
    let second = [1_u8, 2 + 4, 3 + 20, 4 + 41];
    assert_eq!(leaves(&trial), [[&[5, 9, 30, 200], &[200; 12][..], &second, &[120; 12][..]].concat().into()]);
}
