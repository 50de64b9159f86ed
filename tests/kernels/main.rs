//! Every kernel on a device: hand-computed cases, and against its CPU twin at sizes that divide by nothing and on real
//! pictures.
//!
//! A device is part of these tests: without any they fail. Mesa's lavapipe needs no GPU.
#![cfg(feature = "cli")]

mod belief;
mod belief_cost;
mod belief_reduce;
mod belief_select;
mod block_match;
mod box_mean;
mod cell_ranges;
mod census;
mod claim;
mod common;
mod consistency;
mod cost;
mod descriptor;
mod detector;
mod fill;
mod halve;
mod hessian;
mod hybrid;
mod integral_columns;
mod integral_rows;
mod luma;
mod luma_texture;
mod map_texture;
mod matcher;
mod mean_shift;
mod nonmax;
mod orientation;
mod pad;
mod path;
mod random;
mod residual;
mod select;
mod support;
mod verify;
mod weighted_median;
mod workgroups;
