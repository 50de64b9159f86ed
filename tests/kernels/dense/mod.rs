//! The kernels of dense matching.

mod agreement;
mod block_match;
mod box_mean;
mod cell_cost;
mod cell_path;
mod cell_ranges;
mod cell_select;
mod census;
mod claim;
mod consistency;
mod cost;
mod fill;
mod halve;
mod levels;
mod map_texture;
mod matcher;
mod pad;
mod path;
mod residual;
mod select;
mod soft_rank;
mod support;
mod weighted_median;
mod wide_census;
