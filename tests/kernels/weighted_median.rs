//! The weighted median of a map.

use hsad::{
    dense::{Median, WeightedMedian},
    disparity::{DisparityMap, NONE},
    image::{Luma, Plane},
    reference::weighted_median,
};

use crate::common::*;

fn on_device(luma: &Luma, disparities: &DisparityMap, before: &DisparityMap, median: Median) -> Vec<i32> {
    let device = &gpu().device;
    let (from, before, to) = (upload(disparities.data()), upload(before.data()), upload(disparities.data()));
    let kernel = WeightedMedian::new(device, median);
    let dispatch = kernel.prepare(device, disparities.size(), (&upload_luma(luma), 0), [&from, &before], &to);
    poison(&to);
    run(|encoder| dispatch.record(encoder));
    download(&to)
}

fn map(width: u32, height: u32, seed: u32, holes: u8) -> DisparityMap {
    let (coarse, fine) = (picture(width, height, seed), picture(width, height, seed + 1));
    Plane::from_fn(width, height, |x, y| match coarse.get(x, y) {
        value if value < holes => NONE,
        value => (i32::from(value) - 100) * 97 + i32::from(fine.get(x, y)),
    })
}

#[test]
fn the_twin_filters_the_same() {
    for (radius, halving_bits, holes_only) in [(1, 31, false), (2, 3, false), (2, 0, true), (4, 5, true)] {
        let median = Median { radius, halving_bits, holes_only };
        for (width, height) in SIZES {
            let luma = picture(width, height, 91);
            let (disparities, before) = (map(width, height, 92, 40), map(width, height, 92, 90));
            let expected = weighted_median(&luma, &disparities, &before, median);
            let what = format!("{width}x{height} {median:?}");
            assert_same(&what, &on_device(&luma, &disparities, &before, median), expected.data());
        }
    }
}

#[test]
fn by_hand() {
    // The middle one is as dark as its left neighbour, and the bright three to the right of it weigh nothing.
    let luma = Plane::new(5, 1, vec![10, 10, 200, 200, 200]).unwrap();
    let map = Plane::new(5, 1, vec![100, 900, 500, 500, NONE]).unwrap();
    let median = |halving_bits, holes_only| Median { radius: 2, halving_bits, holes_only };
    assert_eq!(on_device(&luma, &map, &map, median(3, false))[..2], [100, 100]);
    // All alike: of 100 500 500 900 the second.
    assert_eq!(on_device(&luma, &map, &map, median(31, false))[1], 500);
    assert_eq!(on_device(&luma, &map, &map, median(31, true)), map.data());
}
