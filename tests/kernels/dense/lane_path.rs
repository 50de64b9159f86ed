//! Paths of semi-global matching, several at once, with threads across disparities.

use hsad::{
    dense::Penalties,
    gpu::{Exchange, Shapes},
    image::{Plane, Size},
    internals::dense::Direction,
    verify::trials::LanePathTrial,
};

use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };

fn trial(width: u32, height: u32, count: u32, band_rows: u32, exchange: Exchange) -> LanePathTrial {
    let costs = picture((width * count, height), 77).data().iter().map(|&value| value / 2).collect();
    let reference = picture((width, height), 71).map(|&value| u32::from(value) | 0xabcd_ef00);
    let directions = Direction::ALL.to_vec();
    LanePathTrial {
        reference,
        costs,
        directions,
        penalties: PENALTIES,
        band_rows,
        lane_disparities: 16,
        lane_threads: 64,
        exchange,
    }
}

#[test]
fn the_twin_goes_the_same_way() {
    for Size { width, height } in SIZES {
        for exchange in Exchange::ALL {
            assert_twin(&format!("{width}x{height} {exchange}"), &trial(width, height, 48, height, exchange));
        }
    }
}

/// One thread per line, as many as a workgroup can have, and numbers that are no power of two.
#[test]
fn any_number_of_disparities_is_shared_out() {
    for count in [16, 32, 64, 80, 256, 272, 528, 1024, 4096] {
        for exchange in Exchange::ALL {
            assert_twin(&format!("{count} disparities {exchange}"), &trial(13, 11, count, 11, exchange));
        }
    }
}

#[test]
fn workgroups_of_any_size_go_the_same_way() {
    for lane_threads in Shapes::LANE_THREADS {
        for lane_disparities in Shapes::LANE_DISPARITIES {
            for exchange in Exchange::ALL {
                let trial = LanePathTrial { lane_disparities, lane_threads, ..trial(37, 20, 32, 20, exchange) };
                assert_twin(&format!("{lane_disparities} disparities, {lane_threads} threads {exchange}"), &trial);
            }
        }
    }
}

/// Lines that are shorter than what is loaded early, and a pixel longer.
#[test]
fn lines_of_any_length_end() {
    for length in 1..=9 {
        assert_twin(&format!("{length} pixels"), &trial(length, length, 32, length, Exchange::Memory));
    }
}

#[test]
fn bands_leave_no_trace() {
    for band_rows in [1, 7] {
        assert_twin(&format!("in bands of {band_rows}"), &trial(37, 20, 32, band_rows, Exchange::Subgroups));
    }
}

#[test]
fn by_hand() {
    // As the path of one thread: tests/kernels/dense/path.rs. Across threads: the second thread's first disparity from the
    // first thread's last one, P1 + 9, before M is taken away; and the one after it by P1 from 60.
    let costs = [&[200; 15][..], &[9, 60], &[200; 15][..], &[0; 32]].concat();
    let trial = LanePathTrial {
        reference: Plane::new((2, 1), vec![7, 7]).unwrap(),
        costs: costs.clone(),
        directions: vec![Direction { dx: 1, dy: 0 }],
        penalties: PENALTIES,
        band_rows: 1,
        lane_disparities: 16,
        lane_threads: 64,
        exchange: Exchange::Memory,
    };
    let second = [&[120; 14][..], &[16, 0, 16, 67], &[120; 14]].concat();
    assert_eq!(leaves(&trial), [[&costs[..32], &second].concat().into()]);
}
