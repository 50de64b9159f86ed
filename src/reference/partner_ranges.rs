//! What is to be searched in the other view, from the definition.

use super::CellPlane;
use crate::{
    dense::{CELL, View},
    disparity::DisparityRange,
    image::Plane,
};

/// What is to be searched in the cells of the other view, where `ranges` are searched in `view`: in each cell all that
/// lies between two disparities with which a pixel of `view` may have its partner there.
pub fn partner_ranges(ranges: &CellPlane, view: View, range: DisparityRange) -> CellPlane {
    let direction = i64::from(view.direction());
    let side = i64::from(CELL);
    let (columns, rows) = ranges.size();
    Plane::from_fn(columns, rows, |column, row| {
        let mut found: Option<(u32, u32)> = None;
        for index in 0..range.count {
            let shift = direction * (i64::from(range.min) + i64::from(index));
            let meets = |from: u32| {
                let (first, count) = ranges.get(from, row);
                // Where the pixels of that cell have their partners.
                let start = i64::from(from) * side + shift - i64::from(column) * side;
                index.wrapping_sub(first) < count && start.abs() < side
            };
            if (0..columns).any(meets) {
                found = Some((found.map_or(index, |(first, _)| first), index));
            }
        }
        found.map_or((0, 0), |(first, last)| (first, last - first + 1))
    })
}
