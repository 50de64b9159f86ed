//! Several paths of semi-global matching.

use super::path::path;
use crate::{
    dense::{Direction, Penalties},
    image::Plane,
};

/// The volume of the stage `path` for each of `directions`, one after the other.
pub fn lane_path(reference: &Plane<u32>, costs: &[u8], penalties: &Penalties, directions: &[Direction]) -> Vec<u8> {
    directions.iter().flat_map(|&direction| path(reference, costs, penalties, direction)).collect()
}
