//! The matching cost.

use hsad::{
    dense::{Cost, CostVolume, Difference, View, VolumeBand},
    disparity::DisparityRange,
    image::Plane,
    reference::{census, cost_volume},
};

use crate::common::*;

const COST: Cost = Cost {
    census: 40,
    difference: Difference { weight: 16, limit: 24 },
    gradient: Difference { weight: 8, limit: 40 },
};

fn on_device(views: [&Plane<u32>; 2], view: View, cost: &Cost, band: &VolumeBand) -> Vec<u8> {
    let device = &gpu().device;
    let volume = upload(&vec![0_u32; (band.row_words() * band.rows) as usize]);
    let [reference, other] = views.map(|plane| upload(plane.data()));
    let kernel = CostVolume::new(device, cost, view).prepare(device, band, [&reference, &other], &volume);
    poison(&volume);
    run(|encoder| kernel.record(encoder));
    bytemuck::cast_slice(&download::<u32>(&volume)).to_vec()
}

fn compare(size: (u32, u32), view: View, cost: &Cost, (min, count): (i32, u32)) {
    let (width, height) = size;
    let range = DisparityRange::new(min, count).unwrap();
    let [a, b] = [1, 2].map(|seed| census(&picture(width, height, seed)));
    let expected = cost_volume([&a, &b], view, cost, range);
    let what = format!("{width}x{height} {view:?} {count} from {min}");
    let band = VolumeBand { width, first_row: 0, rows: height, range };
    assert_same(&what, &on_device([&a, &b], view, cost, &band), &expected);
    if height > 2 {
        let band = VolumeBand { first_row: 1, rows: height - 2, ..band };
        let row = 4 * band.row_words() as usize;
        assert_same(&what, &on_device([&a, &b], view, cost, &band), &expected[row..expected.len() - row]);
    }
}

#[test]
fn the_twin_costs_the_same() {
    for size in SIZES {
        for view in [View::Left, View::Right] {
            compare(size, view, &COST, (0, 17));
        }
    }
    for range in [(0, 1), (-20, 41), (5, 3), (-500, 12), (90, 100)] {
        for view in [View::Left, View::Right] {
            compare((97, 5), view, &COST, range);
        }
    }
    let none = Difference { weight: 0, limit: 0 };
    for cost in [Cost { census: 255, ..COST }, Cost { difference: none, gradient: none, ..COST }] {
        compare((97, 5), View::Left, &cost, (0, 17));
    }
}

#[test]
fn by_hand() {
    // Three bits differ, the luma by 30 and its gradient by 10: (40 * 3 + 16 * 24 + 8 * 10) / 16 = 36.5.
    let a = Plane::new(3, 1, vec![50, 0b111 << 8 | 100, 60]).unwrap();
    let b = Plane::new(3, 1, vec![50, 70, 70]).unwrap();
    let range = DisparityRange::new(0, 1).unwrap();
    let band = VolumeBand { width: 3, first_row: 0, rows: 1, range };
    assert_eq!(on_device([&a, &b], View::Left, &COST, &band)[4], 36);
}
