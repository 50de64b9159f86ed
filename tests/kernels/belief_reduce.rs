//! The data costs of a coarser grid.

use hsad::{hybrid::BeliefReduce, reference::belief_reduced};

use crate::common::*;

fn on_device(costs: &[u16], size: (u32, u32)) -> Vec<u16> {
    let device = &gpu().device;
    let fours = costs.len() as u32 / (4 * size.0 * size.1);
    let coarse = upload(&vec![0_u32; (2 * fours * size.0.div_ceil(2) * size.1.div_ceil(2)) as usize]);
    let kernel = BeliefReduce::new(device).prepare(device, size, fours, &upload(costs), &coarse);
    poison(&coarse);
    run(|encoder| kernel.record(encoder));
    bytemuck::cast_slice(&download::<u32>(&coarse)).to_vec()
}

#[test]
fn the_twin_adds_up_the_same() {
    for (width, height) in SIZES {
        let noise = picture(12 * width, height, 5);
        let costs: Vec<u16> = noise.data().iter().map(|&value| u16::from(value) << 7).collect();
        assert_same(
            &format!("{width}x{height}"),
            &on_device(&costs, (width, height)),
            &belief_reduced(&costs, (width, height)),
        );
    }
}

#[test]
fn by_hand() {
    // Three nodes in a row with four disparities each: the third is a block of its own.
    let costs = [1, 2, 3, 0xffff, 10, 20, 30, 0xffff, 7, 8, 9, 0xffff];
    assert_eq!(on_device(&costs, (3, 1)), [11, 22, 33, 0xffff, 7, 8, 9, 0xffff]);
}
