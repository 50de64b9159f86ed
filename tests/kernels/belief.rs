//! Belief propagation.

use hsad::{
    dense::Brightness,
    hybrid::{Belief, GridBuffers, LinkWeights, Links, Segmentation, Segments, Smoothness, Strip, Turn, described},
    image::Plane,
    reference::{Grid, belief},
};

use crate::{common::*, hybrid::colours};

const SMOOTHNESS: Smoothness = Smoothness { slope: 14, limit: 100 };

/// Messages after a turn that began with `messages`.
fn on_device(grid: Grid<'_>, messages: &[u8], parents: &[u8], smoothness: &Smoothness, turn: Turn) -> Vec<u8> {
    let device = &gpu().device;
    let fours = grid.costs.len() as u32 / (4 * grid.size.0 * grid.size.1);
    let (costs, links) = (upload(grid.costs), upload(grid.links.words().data()));
    let (messages, parents) = (upload(messages), upload(parents));
    let buffers = GridBuffers { costs: &costs, links: &links, parents: &parents, messages: &messages };
    let dispatch = Belief::new(device, smoothness, fours).prepare(device, grid.size, turn, buffers);
    run(|encoder| dispatch.record(encoder));
    download(&messages)
}

pub fn links((width, height): (u32, u32)) -> Links {
    let view = described(&colours(width, height, 9), Brightness::SAME);
    let segments = Segments::new(&view, Segmentation { join: 9, least: 3 });
    let weights = LinkWeights { halving: 9, least: 0, inside: 8, across: 4 };
    Links::new(&view, &segments, Strip { first_row: 0, rows: height }, weights)
}

/// So many bytes of noise, at most `most`.
pub fn noise(count: usize, seed: u32, most: u8) -> Vec<u8> {
    picture(count as u32, 1, seed)
        .data()
        .iter()
        .map(|&value| (u16::from(value) % (u16::from(most) + 1)) as u8)
        .collect()
}

#[test]
fn the_twin_sends_the_same() {
    for (width, height) in SIZES {
        let links = links((width, height));
        for (count, smoothness) in [(12, SMOOTHNESS), (4, Smoothness { slope: 255, limit: 255 })] {
            let nodes = (width * height) as usize;
            let costs: Vec<u16> = noise(nodes * count, 6, 255).into_iter().map(|value| u16::from(value) * 3).collect();
            let grid = Grid { size: (width, height), costs: &costs, links: &links };
            let parents = noise(4 * count * (width.div_ceil(2) * height.div_ceil(2)) as usize, 7, 100);
            let before = noise(4 * count * nodes, 8, 100);
            for (parity, from_parents) in [(0, false), (1, false), (0, true)] {
                let turn = Turn { parity, from_parents };
                let mut expected = before.clone();
                belief(grid, &mut expected, &parents, &smoothness, turn);
                let what = format!("{width}x{height}, {count}, {turn:?}");
                assert_same(&what, &on_device(grid, &before, &parents, &smoothness, turn), &expected);
            }
        }
    }
}

/// Two nodes side by side. The left one has seen costs of 0 30 60 90 for four disparities and knows of a message
/// from the right one that must not come back.
#[test]
fn by_hand() {
    let view = Plane::filled(2, 1, 0x80_000000);
    let segments = Segments::new(&view, Segmentation { join: 0, least: 0 });
    let weights = LinkWeights { halving: 4, least: 0, inside: 0, across: 0 };
    let links = Links::new(&view, &segments, Strip { first_row: 0, rows: 1 }, weights);
    assert_eq!(links.words().data(), [16, 0]);
    let costs = [7, 30, 60, 97, 0, 0, 0, 0];
    let grid = Grid { size: (2, 1), costs: &costs, links: &links };
    let sent = |slope, limit| {
        let messages = [[9; 16], [77; 16]].concat();
        let turn = Turn { parity: 0, from_parents: false };
        on_device(grid, &messages, &[0; 16], &Smoothness { slope, limit }, turn)
    };
    let node = sent(10, 25);
    // Less the least, 7: 0 23 53 90; a step costs 10, 25 at most: 0, 10, 20, 25.
    assert_eq!(node[12..16], [0, 10, 20, 25]);
    // Nobody is above, below or to the left; the other node is not of this parity.
    assert_eq!(node[..12], [0; 12]);
    assert_eq!(node[16..], [77; 16]);
    assert_eq!(sent(200, 255)[12..16], [0, 23, 53, 90]);
}

/// The whole range of what a kernel is made for compiles and sends.
#[test]
fn many_disparities() {
    let (size, count) = ((3, 2), 512);
    let links = links(size);
    let costs: Vec<u16> = noise(6 * count, 6, 255).into_iter().map(u16::from).collect();
    let grid = Grid { size, costs: &costs, links: &links };
    let turn = Turn { parity: 1, from_parents: false };
    let before = noise(4 * 6 * count, 8, 100);
    let mut expected = before.clone();
    belief(grid, &mut expected, &[0; 4], &SMOOTHNESS, turn);
    assert_same("512 disparities", &on_device(grid, &before, &[0; 4], &SMOOTHNESS, turn), &expected);
}
