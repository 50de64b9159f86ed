//! The data costs of a coarser grid.

use hsad::{image::Size, verify::trials::BeliefReduceTrial};

use crate::common::*;

#[test]
fn the_twin_adds_up_the_same() {
    for Size { width, height } in SIZES {
        let noise = picture((12 * width, height), 5);
        let costs = noise.data().iter().map(|&value| u16::from(value) << 7).collect();
        assert_twin(&format!("{width}x{height}"), &BeliefReduceTrial { size: Size::new(width, height), costs });
    }
}

#[test]
fn by_hand() {
    // Three nodes in a row with four disparities each: the third is a block of its own.
    let costs = vec![1, 2, 3, 0xffff, 10, 20, 30, 0xffff, 7, 8, 9, 0xffff];
    let trial = BeliefReduceTrial { size: Size::new(3, 1), costs };
    assert_eq!(leaves(&trial), [vec![11_u32, 22, 33, 0xffff, 7, 8, 9, 0xffff].into()]);
}
