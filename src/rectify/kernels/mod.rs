//! The kernels that resample a view.

pub mod warp;

use crate::gpu::Stage;

/// Every stage that resamples a view.
pub fn stages() -> Vec<Stage> {
    vec![warp::Warp::stage()]
}
