//! Selection of disparities from messages.

use hsad::{
    image::Size,
    internals::kamencay::Winner,
    verify::{Values, trials::BeliefSelectTrial},
};

use super::belief::noise;
use crate::common::*;

#[test]
fn the_twin_selects_the_same() {
    for size in SIZES {
        for disparities in [1_u32, 2, 12, 17] {
            let count = (size.width * size.height * disparities.next_multiple_of(4)) as usize;
            let costs = noise(count, 3, 255).into_iter().map(u16::from).collect();
            let trial = BeliefSelectTrial { size, disparities, costs, messages: noise(4 * count, 4, 255) };
            assert_twin(&format!("{size:?}, {disparities}"), &trial);
        }
    }
}

#[test]
fn by_hand() {
    let costs = vec![5, 3, 9, 9, 4, 4, 4, 4];
    let mut messages = vec![200; 32];
    // Messages to the right from the left node, and to the left from the right node.
    messages[12..16].copy_from_slice(&[8, 1, 1, 0]);
    messages[24..28].copy_from_slice(&[1, 3, 0, 0]);
    let trial = BeliefSelectTrial { size: Size::new(2, 1), disparities: 3, costs, messages };
    // Beliefs 6 6 9 9: a tie goes to the smaller disparity, and its rivals are the last two; and 12 5 5 of three
    // disparities.
    let expected = [Winner::new(0, 6, Some(9)), Winner::new(1, 5, None)];
    assert_eq!(leaves(&trial), [Values::U32(bytemuck::cast_slice(&expected).to_vec())]);
    assert_eq!((expected[0].index(), expected[0].belief(), expected[0].margin()), (0, 6, 3));
    assert_eq!(expected[1].margin(), u32::MAX);
}
