//! The CPU twin of resampling.

mod warp;

pub use warp::{warp, warp_picture};
