//! A path of semi-global matching through cells with ranges of their own, from the definition.

use super::{cell_volume::CellVolume, path::NO_COST};
use crate::{
    dense::{Direction, Penalties},
    image::{Plane, Size},
};

/// The stage `path` where the disparities of a pixel are those of its cell: a disparity that the pixel before does not have
/// costs as much as a jump.
pub fn cell_path(
    reference: &Plane<u32>,
    costs: &CellVolume,
    penalties: &Penalties,
    direction: Direction,
) -> CellVolume {
    let Size { width, height } = costs.table.size;
    let starts = CellVolume::starts(&costs.table);
    let luma = |x: u32, y: u32| reference.get(x, y) & 255;
    let ordered = |length: u32, step: i32| -> Vec<u32> {
        if step < 0 { (0..length).rev().collect() } else { (0..length).collect() }
    };
    let mut values = costs.values.clone();
    for &y in &ordered(height, direction.dy) {
        for &x in &ordered(width, direction.dx) {
            let (qx, qy) = (x.wrapping_add_signed(-direction.dx), y.wrapping_add_signed(-direction.dy));
            if qx >= width || qy >= height {
                continue;
            }
            let p2 = penalties.p2_at(luma(x, y).abs_diff(luma(qx, qy)));
            let place = |x: u32, y: u32| (y * width + x) as usize;
            let (disparities, others) = (costs.table.at(x, y).disparities(), costs.table.at(qx, qy).disparities());
            let before = values[starts[place(qx, qy)]..starts[place(qx, qy) + 1]].to_vec();
            let least = before.iter().copied().min().map_or(0, u32::from);
            let at = |disparity: u32| match disparity.checked_sub(others.start) {
                Some(index) if disparity < others.end => before[index as usize].into(),
                _ => NO_COST,
            };
            for (cost, d) in values[starts[place(x, y)]..].iter_mut().zip(disparities) {
                let step = at(d.wrapping_sub(1)).min(at(d + 1)) + penalties.p1;
                let cheapest = at(d).min(step).min(least + p2);
                *cost = (u32::from(*cost) + cheapest - least) as u8;
            }
        }
    }
    CellVolume { table: costs.table.clone(), values }
}
