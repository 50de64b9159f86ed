//! The CPU twins: every stage written from its definition, for reading, with no GPU in sight.
//!
//! They are what the kernels are tested against, and what computes where there is no adapter.
//! Integer stages equal their kernels bit for bit.

mod belief;
mod belief_cost;
mod belief_reduce;
mod belief_select;
mod block_match;
mod box_mean;
mod cell_ranges;
mod census;
mod claim;
mod consistency;
mod cost;
mod dense;
pub mod descriptor;
pub mod detector;
mod fill;
pub mod haar;
mod halve;
pub mod hessian;
mod hybrid;
pub mod integral;
pub mod integral_columns;
pub mod integral_rows;
pub mod luma;
mod luma_texture;
mod map_texture;
mod mean_shift;
pub mod nonmax;
pub mod orientation;
mod pad;
mod path;
mod residual;
mod select;
mod support;
mod weighted_median;
pub mod workgroups;

pub use belief::{Grid, belief};
pub use belief_cost::belief_cost;
pub use belief_reduce::belief_reduced;
pub use belief_select::belief_select;
pub use block_match::{block_match, cost, winners};
pub use box_mean::box_mean;
pub use cell_ranges::{CellPlane, cell_ranges};
pub use census::census;
pub use claim::claimed;
pub use consistency::{check_consistency, check_half_consistency};
pub use cost::cost_volume;
pub use dense::compute_dense;
pub use fill::filled;
pub use halve::halved;
pub use hybrid::{compute_hybrid, compute_hybrid_within};
pub use luma_texture::{Texels, luma_of_texels};
pub use map_texture::texels_in_pixels;
pub use mean_shift::mean_shift;
pub use pad::{brightened, padded};
pub use path::path;
pub use residual::residuals;
pub use select::{path_winners, select};
pub use support::supported;
pub use weighted_median::weighted_median;
