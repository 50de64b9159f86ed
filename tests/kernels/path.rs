//! A path of semi-global matching.

use hsad::{
    dense::{Direction, Path, Penalties, VolumeBand},
    disparity::DisparityRange,
    image::Plane,
    reference::path,
};

use crate::common::*;

const PENALTIES: Penalties = Penalties { p1: 16, p2: 120, least_p2: 24, p2_scale: 8 };

/// The path through bands of so many rows, each beginning where the one before it ended.
fn on_device(reference: &Plane<u32>, costs: &[u8], direction: Direction, band_rows: u32) -> Vec<u8> {
    let device = &gpu().device;
    let (width, height) = reference.size();
    let count = costs.len() as u32 / (width * height);
    let range = DisparityRange::new(0, count).unwrap();
    let kernel = Path::new(device, &PENALTIES, count.div_ceil(4));
    let view = upload(reference.data());
    let mut out = vec![0; costs.len()];
    let mut firsts: Vec<u32> = (0..height).step_by(band_rows as usize).collect();
    if direction.dy < 0 {
        firsts.reverse();
    }
    let mut carried: Option<Vec<u32>> = None;
    for first_row in firsts {
        let rows = band_rows.min(height - first_row);
        let band = VolumeBand { width, first_row, rows, range };
        let row = band.row_words() as usize;
        let bytes = 4 * row * first_row as usize..4 * row * (first_row + rows) as usize;
        let costs: Vec<u32> = bytemuck::pod_collect_to_vec(&costs[bytes.clone()]);
        // A row in front and one behind, for where lines come from.
        let mut paths = vec![u32::MAX; row * (rows as usize + 2)];
        if let Some(carried) = &carried {
            let at = if direction.dy < 0 { row * (rows as usize + 1) } else { 0 };
            paths[at..at + row].copy_from_slice(carried);
        }
        let (costs, paths) = (upload(&costs), upload(&paths));
        let goes_on = carried.is_some() && direction.dy != 0;
        let dispatch = kernel.prepare(device, &band, direction, &view, &costs, &paths, row as u32, goes_on);
        run(|encoder| dispatch.record(encoder));
        let paths = download::<u32>(&paths);
        out[bytes].copy_from_slice(bytemuck::cast_slice(&paths[row..row * (rows as usize + 1)]));
        let last = if direction.dy < 0 { 1 } else { rows as usize };
        carried = Some(paths[last * row..(last + 1) * row].to_vec());
    }
    out
}

fn costs(width: u32, height: u32, count: u32) -> Vec<u8> {
    picture(width * count, height, 77).data().iter().map(|&value| value / 2).collect()
}

#[test]
fn the_twin_goes_the_same_way() {
    for (width, height) in SIZES {
        let reference = picture(width, height, 71).map(|&value| u32::from(value) | 0xabcd_ef00);
        let costs = costs(width, height, 12);
        for direction in Direction::ALL {
            let expected = path(&reference, &costs, &PENALTIES, direction);
            let what = format!("{width}x{height} {direction:?}");
            assert_same(&what, &on_device(&reference, &costs, direction, height), &expected);
        }
    }
}

#[test]
fn bands_leave_no_trace() {
    let reference = picture(37, 20, 72).map(|&value| value.into());
    let costs = costs(37, 20, 8);
    for direction in Direction::ALL {
        let expected = path(&reference, &costs, &PENALTIES, direction);
        for rows in [1, 7] {
            let what = format!("{direction:?} in bands of {rows}");
            assert_same(&what, &on_device(&reference, &costs, direction, rows), &expected);
        }
    }
}

#[test]
fn by_hand() {
    // Two pixels of the same luma. From 5 9 30 90: stays at 5; 9; 9 + P1 = 25 before 30; the jump, 5 + P2.
    let reference = Plane::new(2, 1, vec![7, 7]).unwrap();
    let out = on_device(&reference, &[5, 9, 30, 200, 1, 2, 3, 4], Direction { dx: 1, dy: 0 }, 1);
    assert_eq!(out, [5, 9, 30, 200, 1, 2 + 4, 3 + 20, 4 + 41]);
}
