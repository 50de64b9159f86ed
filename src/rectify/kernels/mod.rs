//! The kernels that resample a view.

pub mod warp;
pub mod warp_colours;

use crate::gpu::Stage;

/// Every stage that resamples a view.
pub fn stages() -> Vec<Stage> {
    vec![warp::Warp::stage(), warp_colours::WarpColours::stage()]
}
