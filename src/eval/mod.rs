//! How good a disparity map is, and how good matches are, also under changes of the picture.

pub mod conditions;
mod metrics;

pub use metrics::{Bad, Score, score};
