//! The CPU twins of resampling.

mod warp;
mod warp_colours;

pub use warp::warp;
pub use warp_colours::warp_colours;
