//! The data costs of a coarser grid, from the definition.

use crate::{image::Size, kamencay::FAR};

/// The data costs of the grid of half the size: per disparity, the sum over a block of 2x2 nodes, at most [`FAR`].
pub fn belief_reduce(costs: &[u16], Size { width, height }: Size) -> Vec<u16> {
    let count = costs.len() / (width as usize * height as usize);
    let (columns, rows) = (width.div_ceil(2) as usize, height.div_ceil(2) as usize);
    let mut sums = vec![0_u32; columns * rows * count];
    for (node, costs) in costs.chunks(count).enumerate() {
        let (x, y) = (node % width as usize, node / width as usize);
        let block = (y / 2 * columns + x / 2) * count;
        sums[block..][..count].iter_mut().zip(costs).for_each(|(sum, &cost)| *sum += u32::from(cost));
    }
    sums.into_iter().map(|sum| sum.min(FAR) as u16).collect()
}
