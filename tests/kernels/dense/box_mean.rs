//! The mean cost over a square window.

use std::ops::Range;

use hsad::{
    disparity::DisparityRange,
    image::Size,
    internals::{
        cpu::dense::box_mean,
        dense::{BoxMean, VolumeBand},
    },
};

use crate::common::*;

/// The means of `output_rows`, from the costs of `input_rows`.
fn on_device(
    costs: &[u8],
    width: u32,
    side: u32,
    input_rows: Range<u32>,
    output_rows: Range<u32>,
    count: u32,
) -> Vec<u8> {
    let range = DisparityRange::new(0, count).unwrap();
    let band = VolumeBand { width, first_row: 0, rows: input_rows.end - input_rows.start, range };
    let row = 4 * band.row_words() as usize;
    let costs = &costs[row * input_rows.start as usize..row * input_rows.end as usize];
    let costs = upload(&bytemuck::pod_collect_to_vec::<u8, u32>(costs));
    let means = upload(&vec![u32::MAX; (band.row_words() * band.rows) as usize]);
    let rows = output_rows.start - input_rows.start..output_rows.end - input_rows.start;
    let dispatches = BoxMean::new(gpu(), side).prepare(&band, rows.clone(), &costs, &means);
    bench().run(|encoder| dispatches.iter().for_each(|dispatch| dispatch.record(encoder)));
    bytemuck::cast_slice(&download::<u32>(&costs))[..row * rows.len()].to_vec()
}

fn costs(width: u32, height: u32, count: u32) -> Vec<u8> {
    picture((width * count.next_multiple_of(16), height), 78).data().to_vec()
}

#[test]
fn the_twin_averages_the_same() {
    for Size { width, height } in SIZES {
        for (side, count) in [(3, 17), (7, 4), (31, 33)] {
            let costs = costs(width, height, count);
            let expected = box_mean(&costs, Size::new(width, height), side);
            let actual = on_device(&costs, width, side, 0..height, 0..height, count);
            assert_same(&format!("{width}x{height}, {count} disparities, side {side}"), &actual, &expected);
        }
    }
}

/// Covers every side, with the largest sums.
#[test]
fn no_quotient_is_off() {
    for side in (1..=31).step_by(2) {
        let costs: Vec<u8> = costs(67, 5, 8).iter().map(|&cost| if cost > 90 { 255 } else { cost }).collect();
        let expected = box_mean(&costs, Size::new(67, 5), side);
        assert_same(&format!("side {side}"), &on_device(&costs, 67, side, 0..5, 0..5, 8), &expected);
    }
}

#[test]
fn a_band_needs_no_more_than_half_a_window_around_it() {
    let (width, height, side) = (37, 40, 7);
    let costs = costs(width, height, 16);
    let expected = box_mean(&costs, Size::new(width, height), side);
    for output_rows in [0..1_u32, 2..9, 20..21, 30..40, 0..40] {
        let input_rows = output_rows.start.saturating_sub(3)..(output_rows.end + 3).min(height);
        let actual = on_device(&costs, width, side, input_rows, output_rows.clone(), 16);
        let row = 16 * width as usize;
        let expected = &expected[row * output_rows.start as usize..row * output_rows.end as usize];
        assert_same(&format!("rows {output_rows:?}"), &actual, expected);
    }
}

#[test]
fn by_hand() {
    // Four disparities of 3x2 pixels, four times: ramps along the row and along the column, a lone pixel, a constant.
    let pixel = |x: u8, y: u8| [10 * x, 30 * y, if (x, y) == (2, 0) { 90 } else { 0 }, 255].repeat(4);
    let costs: Vec<u8> = (0..2).flat_map(|y| (0..3).flat_map(move |x| pixel(x, y))).collect();
    // Means along the row: 0 0 10 is 3, 0 10 20 is 10, 10 20 20 is 17; along the column: 0 0 30 is 10, 0 30 30 is 20.
    // The lone pixel counts once in its row beside it and twice at the edge: 30, 60; likewise in the columns.
    let expected =
        [[3, 10, 0, 255], [10, 10, 20, 255], [17, 10, 40, 255], [3, 20, 0, 255], [10, 20, 10, 255], [17, 20, 20, 255]]
            .map(|pixel| pixel.repeat(4))
            .concat();
    assert_eq!(on_device(&costs, 3, 3, 0..2, 0..2, 16), expected);
    assert_eq!(box_mean(&costs, Size::new(3, 2), 3), expected);
}
