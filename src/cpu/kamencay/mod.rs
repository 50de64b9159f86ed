//! The CPU twins of Kamencay's method.

mod belief;
mod belief_cost;
mod belief_reduce;
mod belief_select;
mod compute;
mod mean_shift;

pub use belief::{Grid, belief};
pub use belief_cost::belief_cost;
pub use belief_reduce::belief_reduce;
pub use belief_select::belief_select;
pub use compute::{compute, compute_within};
pub use mean_shift::mean_shift;
