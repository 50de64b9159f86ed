//! Selection of disparities by the summed costs of stored paths, with threads across disparities.

use hsad::{
    dense::Interpolation,
    disparity::{DisparityRange, SCALE},
    image::Size,
    verify::trials::LaneSelectTrial,
};

use crate::common::*;

#[test]
fn the_twin_selects_the_same() {
    for size in SIZES {
        for (count, paths, uniqueness) in [(1_u32, 3, 0), (2, 1, 0), (17, 4, 10), (40, 8, 1), (270, 3, 10)] {
            for interpolation in [Interpolation::None, Interpolation::Parabola, Interpolation::Equiangular] {
                let volume = |seed| picture((size.width * count.next_multiple_of(16), size.height), seed).into_data();
                let trial = LaneSelectTrial {
                    size,
                    paths: (0..paths).map(volume).collect(),
                    range: DisparityRange::new(-3, count).unwrap(),
                    interpolation,
                    uniqueness,
                    lane_threads: 64,
                };
                assert_twin(&format!("{size}, {count} disparities, {paths} paths, {interpolation:?}"), &trial);
            }
        }
    }
}

#[test]
fn by_hand() {
    // Sums 90 at 14, 20 at 15, 30 at 16 and 80 at 17 disparities, 510 elsewhere: the winner is the last disparity of the
    // first thread, its upper neighbour and its rival are the second thread's. The parabola's vertex lies
    // (70 - 10) / 2(70 + 10) = 0.375 px to the right.
    let costs = [&[255; 14][..], &[45, 10, 15, 40], &[255; 14]].concat();
    let trial = LaneSelectTrial {
        size: Size::new(1, 1),
        paths: vec![costs.clone(), costs],
        range: DisparityRange::new(0, 32).unwrap(),
        interpolation: Interpolation::Parabola,
        uniqueness: 0,
        lane_threads: 64,
    };
    let (confidence, key) = (1 + 254 * 60 / 80_u32, 20_u32 << 16 | 15);
    assert_eq!(leaves(&trial), [vec![15 * SCALE + 96].into(), vec![confidence].into(), vec![key].into()]);
}
