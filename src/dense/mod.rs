//! The dense half (paper, step 5): a disparity for every pixel.
//!
//! padding -> block matching (cost, winner-take-all, uniqueness, sub-pixel) for both views ->
//! left-right consistency. All of it is integer arithmetic and equals the CPU twins bit for bit.

mod block_match;
mod config;
mod consistency;
mod matcher;
mod pad;

use crate::{disparity::DisparityRange, gpu::Stage};

pub use block_match::{BlockMatch, Layout, Tile, Wanted};
pub use config::{DenseConfig, Interpolation, View};
pub use consistency::Consistency;
pub use matcher::{Dense, Matcher, compute};
pub use pad::{Pad, PadParams};

/// Every stage of the dense half, for checks that need no GPU; block matching once for each
/// window, for what each view is asked for.
pub fn stages() -> Vec<Stage> {
    let mut stages = vec![Pad::stage(), Consistency::stage()];
    for window in (3..=31).step_by(2) {
        let tile = if window % 4 == 1 { Tile::HARDWARE } else { Tile::SOFTWARE };
        let config = DenseConfig { window, ..DenseConfig::new(DisparityRange { min: 0, count: 1 }) };
        let asked = [(View::Left, Wanted::Matches), (View::Right, Wanted::Winners)];
        stages.extend(asked.map(|(view, wanted)| BlockMatch::stage(&config, view, wanted, tile)));
    }
    stages
}
