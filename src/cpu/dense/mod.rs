//! The CPU twins of dense matching.

mod block_match;
mod box_mean;
mod cell_ranges;
mod census;
mod claim;
mod compute;
mod consistency;
mod cost;
mod fill;
mod halve;
mod map_texture;
mod pad;
mod path;
mod residual;
mod select;
mod support;
mod weighted_median;
mod wide_census;

pub use block_match::{block_match, winners};
pub use box_mean::box_mean;
pub use cell_ranges::{CellPlane, cell_ranges};
pub use census::census;
pub use claim::claim;
pub use compute::{compute, refined};
pub use consistency::{consistency, half_consistency};
pub use cost::{Transforms, cost};
pub use fill::fill;
pub use halve::halve;
pub use map_texture::map_texture;
pub use pad::pad;
pub use path::path;
pub use residual::residual;
pub use select::{path_winners, select};
pub use support::support;
pub use weighted_median::weighted_median;
pub use wide_census::wide_census;
