//! The kernel of resampling.

mod warp;
