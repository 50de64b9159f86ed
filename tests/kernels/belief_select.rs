//! From messages to disparities.

use hsad::{
    hybrid::{BeliefSelect, Winner},
    reference::{Grid, belief_select},
};

use crate::{
    belief::{links, noise},
    common::*,
};

fn on_device(grid: Grid<'_>, messages: &[u8], disparities: u32) -> Vec<Winner> {
    let device = &gpu().device;
    let (costs, messages) = (upload(grid.costs), upload(messages));
    let winners = upload(&vec![0_u32; (2 * grid.size.0 * grid.size.1) as usize]);
    let kernel = BeliefSelect::new(device);
    let dispatch = kernel.prepare(device, grid.size, disparities, [&costs, &messages], &winners);
    poison(&winners);
    run(|encoder| dispatch.record(encoder));
    download(&winners)
}

#[test]
fn the_twin_selects_the_same() {
    for (width, height) in SIZES {
        let links = links((width, height));
        for disparities in [1_u32, 2, 12, 17] {
            let count = (width * height * disparities.next_multiple_of(4)) as usize;
            let costs: Vec<u16> = noise(count, 3, 255).into_iter().map(u16::from).collect();
            let messages = noise(4 * count, 4, 255);
            let grid = Grid { size: (width, height), costs: &costs, links: &links };
            let what = format!("{width}x{height}, {disparities}");
            assert_same(&what, &on_device(grid, &messages, disparities), &belief_select(grid, &messages, disparities));
        }
    }
}

#[test]
fn by_hand() {
    let links = links((2, 1));
    let costs = [5, 3, 9, 9, 4, 4, 4, 4];
    let mut messages = [200; 32];
    // To the right from the left node, and to the left from the right one.
    messages[12..16].copy_from_slice(&[8, 1, 1, 0]);
    messages[24..28].copy_from_slice(&[1, 3, 0, 0]);
    let grid = Grid { size: (2, 1), costs: &costs, links: &links };
    // 6 6 9 9, of two the smaller disparity, whose rivals are the last two; and 12 5 5 of three.
    let expected = [Winner::new(0, 6, Some(9)), Winner::new(1, 5, None)];
    assert_eq!(on_device(grid, &messages, 3), expected);
    assert_eq!((expected[0].index(), expected[0].belief(), expected[0].margin()), (0, 6, 3));
    assert_eq!(expected[1].margin(), u32::MAX);
}
