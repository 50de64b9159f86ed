//! The CPU twins: every stage written from its definition, for reading, without a GPU.
//!
//! Kernels are tested against the twins, and the twins compute where there is no adapter. Integer stages equal their
//! kernels bit for bit. A twin has its stage's name: `cpu::dense::census` is the twin of `shaders/dense/census.wgsl`.

pub mod dense;
pub mod features;
pub mod kamencay;
pub mod luma;
pub mod rectify;
