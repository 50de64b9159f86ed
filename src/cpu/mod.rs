//! The CPU twins: every stage written from its definition, for reading, with no GPU in sight.
//!
//! The twins are what the kernels are tested against, and what computes where there is no adapter. Integer stages equal
//! their kernels bit for bit. A twin has its stage's name: `cpu::dense::census` is the twin of `shaders/dense/census.wgsl`.

pub mod dense;
pub mod features;
pub mod kamencay;
pub mod luma;
