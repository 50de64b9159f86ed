//! Every kernel on a device: hand-computed cases, and against its CPU twin at sizes that divide by nothing and on real
//! pictures.
//!
//! A device is part of these tests: without any they fail. Mesa's lavapipe needs no GPU.
#![cfg(feature = "cli")]

mod common;
mod dense;
mod features;
mod kamencay;
mod luma;
mod random;
mod verify;
