//! The dense half (paper, step 5): a disparity for every pixel.
//!
//! padding -> block matching (cost, winner-take-all, uniqueness, sub-pixel) for both views ->
//! left-right consistency. All of it is integer arithmetic and equals the CPU twins bit for bit.

mod block_match;
mod config;
mod consistency;
mod matcher;
mod pad;

pub use block_match::BlockMatch;
pub use config::{DenseConfig, Interpolation, View};
pub use consistency::Consistency;
pub use matcher::{Dense, Matcher, compute};
pub use pad::Pad;
