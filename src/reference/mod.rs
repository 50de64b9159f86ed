//! The CPU twins: every stage once more in plain Rust, written from its definition.
//!
//! They are what the kernels are held against, and the backend of a machine without a GPU. Integer
//! stages give the kernels' results bit for bit; positions, orientations and descriptors are `f32`
//! and agree within a stated tolerance.

pub mod descriptor;
pub mod detector;
pub mod haar;
pub mod hessian;
pub mod integral;
pub mod luma;
pub mod nonmax;
pub mod orientation;
