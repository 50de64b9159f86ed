//! Every kernel on a device: hand-computed cases, and sizes that divide by nothing.
//!
//! A device is part of these tests: without any they fail. Mesa's lavapipe needs no GPU.

mod block_match;
mod common;
mod consistency;
mod descriptor;
mod detector;
mod dispatch;
mod hessian;
mod integral;
mod luma;
mod matcher;
mod nonmax;
mod orientation;
mod pad;
