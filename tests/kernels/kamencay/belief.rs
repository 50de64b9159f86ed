//! Belief propagation.

use hsad::{
    dense::Brightness,
    image::{Plane, Size},
    internals::kamencay::{Links, Segments, Strip, Turn, described},
    kamencay::{LinkWeights, Segmentation, Smoothness},
    verify::{Values, trials::BeliefTrial},
};

use crate::{common::*, kamencay::compute::colours};

const SMOOTHNESS: Smoothness = Smoothness { slope: 14, limit: 100 };

fn links(Size { width, height }: Size) -> Links {
    let view = described(&colours((width, height), 9), Brightness::SAME);
    let segments = Segments::new(&view, Segmentation { join: 9, least: 3 });
    let weights = LinkWeights { halving: 9, least: 0, inside: 8, across: 4 };
    Links::new(&view, &segments, Strip { first_row: 0, rows: height }, weights)
}

/// Noise of `count` bytes, at most `most`.
pub fn noise(count: usize, seed: u32, most: u8) -> Vec<u8> {
    picture((count as u32, 1), seed)
        .data()
        .iter()
        .map(|&value| (u16::from(value) % (u16::from(most) + 1)) as u8)
        .collect()
}

#[test]
fn the_twin_sends_the_same() {
    for Size { width, height } in SIZES {
        let links = links(Size::new(width, height));
        for (count, smoothness) in [(12, SMOOTHNESS), (4, Smoothness { slope: 255, limit: 255 })] {
            let nodes = (width * height) as usize;
            let costs: Vec<u16> = noise(nodes * count, 6, 255).into_iter().map(|value| u16::from(value) * 3).collect();
            let parents = noise(4 * count * (width.div_ceil(2) * height.div_ceil(2)) as usize, 7, 100);
            let messages = noise(4 * count * nodes, 8, 100);
            let trial = BeliefTrial {
                costs,
                links: links.clone(),
                messages,
                parents,
                smoothness,
                turn: Turn { parity: 0, from_parents: false },
            };
            for (parity, from_parents) in [(0, false), (1, false), (0, true)] {
                let turn = Turn { parity, from_parents };
                assert_twin(&format!("{width}x{height}, {count}, {turn:?}"), &BeliefTrial { turn, ..trial.clone() });
            }
        }
    }
}

/// Two nodes side by side. The left node has data costs 0 30 60 90 for four disparities, and a message from the right
/// node, which must not be sent back.
#[test]
fn by_hand() {
    let view = Plane::filled((2, 1), 0x80_000000);
    let segments = Segments::new(&view, Segmentation { join: 0, least: 0 });
    let weights = LinkWeights { halving: 4, least: 0, inside: 0, across: 0 };
    let links = Links::new(&view, &segments, Strip { first_row: 0, rows: 1 }, weights);
    assert_eq!(links.words().data(), [16, 0]);
    let sent = |slope, limit| {
        let trial = BeliefTrial {
            costs: vec![7, 30, 60, 97, 0, 0, 0, 0],
            links: links.clone(),
            messages: [[9; 16], [77; 16]].concat(),
            parents: vec![0; 16],
            smoothness: Smoothness { slope, limit },
            turn: Turn { parity: 0, from_parents: false },
        };
        match leaves(&trial).remove(0) {
            Values::U8(messages) => messages,
            other => panic!("messages are bytes, not {}", other.kind()),
        }
    };
    let node = sent(10, 25);
    // Costs minus the least, 7: 0 23 53 90; a step costs 10, at most 25: 0, 10, 20, 25.
    assert_eq!(node[12..16], [0, 10, 20, 25]);
    // There is no neighbour above, below or to the left; the other node has the other parity.
    assert_eq!(node[..12], [0; 12]);
    assert_eq!(node[16..], [77; 16]);
    assert_eq!(sent(200, 255)[12..16], [0, 23, 53, 90]);
}

/// The largest number of disparities compiles and sends.
#[test]
fn many_disparities() {
    let count = 512;
    let trial = BeliefTrial {
        costs: noise(6 * count, 6, 255).into_iter().map(u16::from).collect(),
        links: links(Size::new(3, 2)),
        messages: noise(4 * 6 * count, 8, 100),
        parents: vec![0; 4],
        smoothness: SMOOTHNESS,
        turn: Turn { parity: 1, from_parents: false },
    };
    assert_twin("512 disparities", &trial);
}

/// Where all data costs are clamped, messages add to the largest cost.
#[test]
fn costs_that_are_cut_off_are_still_compared() {
    let (size, count) = (Size::new(3, 2), 8);
    let trial = BeliefTrial {
        costs: vec![u16::MAX; 6 * count],
        links: links(size),
        messages: noise(4 * count * 6, 8, 100),
        parents: noise(4 * count * 2, 7, 100),
        smoothness: SMOOTHNESS,
        turn: Turn { parity: 0, from_parents: false },
    };
    assert_twin("cut off", &trial);
}

/// A slope of 1, which the weight of a link rounds down to 0: differences are free, up to any distance.
#[test]
fn a_slope_that_links_round_to_nothing() {
    let (size, count) = (Size::new(1, 6), 12);
    let trial = BeliefTrial {
        costs: noise(6 * count, 6, 255).into_iter().map(u16::from).collect(),
        links: links(size),
        messages: noise(4 * count * 6, 8, 100),
        parents: noise(4 * count * 3, 7, 100),
        smoothness: Smoothness { slope: 1, limit: 100 },
        turn: Turn { parity: 0, from_parents: false },
    };
    assert_twin("weak slope", &trial);
}
