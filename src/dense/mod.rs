//! The dense half (paper, step 5): a disparity for every pixel.
//!
//! padding -> block matching (cost, winner-take-all, uniqueness, sub-pixel) for both views ->
//! left-right consistency. All of it is integer arithmetic and equals the CPU twins bit for bit.

mod block_match;
mod config;
mod consistency;
mod matcher;
mod pad;

pub use block_match::{BlockMatch, Layout};
pub use config::{DenseConfig, Interpolation, View};
pub use consistency::Consistency;
pub use matcher::{Dense, Matcher, compute};
pub use pad::{Pad, PadParams};

/// Every stage of the dense half, for checks that need no GPU; block matching once for each window.
pub fn stages() -> Vec<crate::gpu::Stage> {
    let mut stages = vec![Pad::stage(), Consistency::stage()];
    for window in (3..=31).step_by(2) {
        stages.push(BlockMatch::stage(&DenseConfig { window, ..DenseConfig::new(SOME_RANGE) }));
    }
    stages
}

const SOME_RANGE: crate::disparity::DisparityRange = crate::disparity::DisparityRange { min: 0, count: 1 };
