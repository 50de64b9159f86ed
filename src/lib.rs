//! Stereo depth from two photographs, on any GPU.

pub mod config;
pub mod dense;
pub mod disparity;
pub mod error;
pub mod eval;
pub mod features;
pub mod gpu;
pub mod image;
pub mod io;
pub mod luma;
pub mod matching;
pub mod pair;
pub mod pipeline;
pub mod reference;
pub mod seeding;

pub use error::{Error, Result};
pub use wgpu;

/// Every stage there is, for checks that need no GPU.
pub fn stages() -> Vec<gpu::Stage> {
    let mut stages = vec![luma::stage()];
    stages.extend(features::stages());
    stages.extend(dense::stages());
    stages
}
