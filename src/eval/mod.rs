//! How good a disparity map is.

mod metrics;

pub use metrics::{Bad, Score, score};
