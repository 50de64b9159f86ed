//! Kamencay's method in one call.

use super::{
    belief::{Grid, belief},
    belief_cost, belief_reduce, belief_select, mean_shift,
};
use crate::{
    dense::Dense,
    error::Result,
    image::{Plane, Size},
    io::Picture,
    kamencay::{
        KamencayConfig, Links, MAX_MESSAGE_BYTES, Problem, Solver, Strip,
        kernels::{Turn, Winner},
        solve,
    },
};

/// [`crate::kamencay::compute`] on the CPU.
///
/// # Errors
/// [`crate::Error::SizesDiffer`], [`crate::Error::Parameter`]; [`crate::Error::TooLarge`] if a strip cannot hold enough
/// rows of this width.
pub fn compute(left: &Picture, right: &Picture, config: &KamencayConfig) -> Result<Dense> {
    compute_within(left, right, config, MAX_MESSAGE_BYTES)
}

/// [`crate::kamencay::compute_within`] on the CPU.
///
/// # Errors
/// See [`compute`].
pub fn compute_within(left: &Picture, right: &Picture, config: &KamencayConfig, message_bytes: u64) -> Result<Dense> {
    // The futures of the twins are always ready.
    pollster::block_on(solve(left, right, config, message_bytes, &mut Twins))
}

struct Twins;

impl Solver for Twins {
    async fn modes(&mut self, problem: &Problem) -> Result<Plane<u32>> {
        Ok(mean_shift(&problem.left, &problem.parameters.mean_shift))
    }

    async fn winners(&mut self, problem: &Problem, strip: Strip, grids: &[(Size, Links)]) -> Result<Vec<Winner>> {
        let Problem { left, right, range, parameters } = problem;
        let mut costs = vec![belief_cost([left, right], strip, &parameters.cost, *range)];
        for (level, &(size, _)) in grids.iter().enumerate().take(grids.len() - 1) {
            costs.push(belief_reduce(&costs[level], size));
        }
        let mut messages = Vec::new();
        for (level, ((size, links), costs)) in grids.iter().zip(&costs).enumerate().rev() {
            let coarsest = level + 1 == grids.len();
            let grid = Grid { size: *size, costs, links };
            let parents = std::mem::replace(&mut messages, vec![0; 4 * costs.len()]);
            for turn in 0..parameters.turns {
                let turn = Turn { parity: turn % 2, from_parents: turn == 0 && !coarsest };
                belief(grid, &mut messages, &parents, &parameters.smoothness, turn);
            }
        }
        let (size, links) = &grids[0];
        Ok(belief_select(Grid { size: *size, costs: &costs[0], links }, &messages, range.count))
    }
}
