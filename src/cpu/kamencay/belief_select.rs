//! Selection of disparities from messages, from the definition.

use rayon::prelude::*;

use super::belief::Grid;
use crate::{image::Size, kamencay::kernels::Winner};

/// The winner of each node: the disparity of least belief among the first `disparities`, ties to the smaller disparity.
pub fn belief_select(grid: Grid<'_>, messages: &[u8], disparities: u32) -> Vec<Winner> {
    let Size { width, height } = grid.size;
    let winner = |node: u32| {
        let beliefs = &grid.belief(messages, (node % width, node / width), None, false)[..disparities as usize];
        let (belief, index) = (0..).zip(beliefs).map(|(index, &belief)| (belief, index)).min().unwrap_or((0, 0));
        let away = (0_u32..).zip(beliefs).filter(|(other, _)| other.abs_diff(index) >= 2);
        Winner::new(index, belief, away.map(|(_, &belief)| belief).min())
    };
    (0..width * height).into_par_iter().map(winner).collect()
}
