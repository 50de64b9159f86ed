//! Every kernel on a device: hand-computed cases, and comparison with its CPU twin, at sizes without common divisors
//! and on real pictures.
//!
//! These tests need a device and fail without one. Mesa's lavapipe needs no GPU.
#![cfg(feature = "cli")]

mod common;
mod dense;
mod features;
mod kamencay;
mod luma;
mod random;
mod rectify;
mod verify;
