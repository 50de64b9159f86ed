//! Every kernel on a device: hand-computed cases, and against its CPU twin at sizes that divide by nothing and on real
//! pictures.
//!
//! A device is part of these tests: without any they fail. Mesa's lavapipe needs no GPU.
#![cfg(feature = "cli")]

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
mod integral_columns;
mod integral_rows;
mod luma;
mod matcher;
mod nonmax;
mod orientation;
mod pad;
mod path;
mod select;
mod support;
mod weighted_median;
mod workgroups;
