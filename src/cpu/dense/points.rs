//! Points of a map, from the definition.

use super::point_counts::is_point;
use crate::{
    dense::{
        Dense,
        kernels::{PointLayout, PointRule},
        reprojection::DepthTable,
    },
    image::Plane,
};

/// Points as the device writes them.
#[derive(Clone, Debug, PartialEq)]
pub struct PointList {
    /// Vertices, instances, first vertex and first instance of the draw.
    pub arguments: [u32; 4],
    /// x, y and z as the bits of floats; red, green, blue and confidence as bytes, the first one lowest.
    pub vertices: Vec<[u32; 4]>,
}

/// The points of a map in raster order, coloured by `picture` (red, green and blue).
pub fn points(
    dense: &Dense,
    picture: &Plane<[u8; 3]>,
    table: &DepthTable,
    rule: PointRule,
    PointLayout { centre: [cx, cy], capacity, instanced }: PointLayout,
) -> PointList {
    let (width, height) = (dense.disparity.width(), dense.disparity.height());
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let vertex = |(x, y): (u32, u32)| {
        let [depth, per_pixel] = table.at(dense.disparity.get(x, y));
        let position = [(x as f32 - cx) * per_pixel, (y as f32 - cy) * per_pixel, depth];
        let [red, green, blue] = picture.get(x, y);
        let [x_bits, y_bits, z_bits] = position.map(f32::to_bits);
        [x_bits, y_bits, z_bits, u32::from_le_bytes([red, green, blue, dense.confidence.get(x, y)])]
    };
    let kept = pixels.filter(|&(x, y)| is_point(dense, rule, x, y)).take(capacity as usize);
    let vertices: Vec<_> = kept.map(vertex).collect();
    let count = vertices.len() as u32;
    let arguments = if instanced == 0 { [count, 1, 0, 0] } else { [instanced, count, 0, 0] };
    PointList { arguments, vertices }
}
