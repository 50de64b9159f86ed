//! Stereo depth from two photographs, on any GPU.

pub mod disparity;
pub mod error;
pub mod eval;
pub mod features;
pub mod gpu;
pub mod image;
pub mod matching;
pub mod reference;
pub mod seeding;

pub use error::{Error, Result};
pub use wgpu;
