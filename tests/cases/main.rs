//! Situations that people report: what `hsad match` makes of them, and what the program says.
//!
//! Each test makes a small pair that shows one situation, from the shipped scenes or from rendered layers. `shared/`
//! walks a folder of further pairs, if it is at hand.

#![cfg(feature = "cli")]

mod deep;
mod pair;
mod ranges;
mod repeated;
mod rows;
mod run;
mod scene;
mod shared;
mod sizes;
#[path = "../texture/mod.rs"]
mod texture;
mod trust;
mod unseen;
