//! The kernels of resampling.

mod warp;
mod warp_colours;
