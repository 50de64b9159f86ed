//! The kernels of Kamencay's method.

mod belief;
mod belief_cost;
mod belief_reduce;
mod belief_select;
mod compute;
mod mean_shift;
