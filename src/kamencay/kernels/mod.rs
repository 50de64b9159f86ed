//! The kernels of Kamencay's method, one per stage.

mod belief;
mod belief_cost;
mod belief_reduce;
mod belief_select;
mod mean_shift;

pub use belief::{Belief, GridBuffers, Smoothness, Turn};
pub use belief_cost::{BeliefCost, MAX_DATA_COST, WindowCost};
pub use belief_reduce::BeliefReduce;
pub use belief_select::{BeliefSelect, Winner};
pub use mean_shift::{MeanShift, ModeSeeking, STILL};

use crate::{dense::config::Difference, gpu::Stage};

/// Every stage of Kamencay's method, for checks that need no GPU.
pub fn stages() -> Vec<Stage> {
    let part = Difference { weight: 1, limit: 1 };
    let costs = [0, 3].map(|radius| BeliefCost::stage(&WindowCost { radius, color: part, gradient: part }));
    let mut stages = vec![
        MeanShift::stage(&ModeSeeking { radius: 1, range: 1, turns: 1 }),
        BeliefReduce::stage(),
        Belief::stage(&Smoothness { slope: 1, limit: 2 }, 2),
        BeliefSelect::stage(),
    ];
    stages.extend(costs);
    stages
}
