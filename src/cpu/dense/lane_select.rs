//! Selection of disparities by the summed costs of stored paths.

use super::select::{path_winners, select};
use crate::{
    dense::{Dense, DenseConfig},
    image::{Plane, Size},
};

/// The stage `select` and its winners, where the costs of all `paths` are stored.
pub fn lane_select(paths: &[Vec<u8>], size: Size, config: &DenseConfig) -> (Dense, Plane<Option<(u32, i32)>>) {
    (select(paths, size, config), path_winners(paths, size, config))
}
