//! Depths of a map, from the definition.

use crate::{dense::reprojection::DepthTable, disparity::DisparityMap};

/// The depth of each pixel, in metres; 0 where there is none.
pub fn depth_texture(map: &DisparityMap, table: &DepthTable) -> Vec<f32> {
    map.data().iter().map(|&disparity| table.at(disparity)[0]).collect()
}
