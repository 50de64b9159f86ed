//! The kernels of dense matching.

mod agreement;
mod bitmap;
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
mod project;
mod residual;
mod select;
mod soft_rank;
mod support;
mod tangent;
mod weighted_median;
