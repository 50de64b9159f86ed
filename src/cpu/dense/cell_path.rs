//! A path of semi-global matching through cells with ranges of their own, from the definition.

use super::cell_volume::CellVolume;
use crate::{
    dense::{Direction, Penalties},
    image::{Plane, Size},
};

/// The path cost of a disparity that a pixel does not have: the largest of all.
const LARGEST: u32 = u8::MAX as u32;

/// The stage `path` where the disparities of a pixel are those of its cell: a disparity that the pixel before does not have
/// has the largest path cost there.
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
    // Costs of the pixel before on the path at the disparities of a pixel, between those at one less and at one more.
    let mut before = Vec::new();
    for &y in &ordered(height, direction.dy) {
        for &x in &ordered(width, direction.dx) {
            let (qx, qy) = (x.wrapping_add_signed(-direction.dx), y.wrapping_add_signed(-direction.dy));
            if qx >= width || qy >= height {
                continue;
            }
            let p2 = penalties.p2_at(luma(x, y).abs_diff(luma(qx, qy)));
            let place = |x: u32, y: u32| (y * width + x) as usize;
            let (disparities, others) = (costs.table.at(x, y).disparities(), costs.table.at(qx, qy).disparities());
            let costs_before = &values[starts[place(qx, qy)]..starts[place(qx, qy) + 1]];
            let least = costs_before.iter().copied().min().map_or(0, u32::from);
            before.clear();
            before.extend((disparities.start..disparities.end + 2).map(|behind| {
                let cost = behind.checked_sub(1 + others.start).and_then(|index| costs_before.get(index as usize));
                cost.map_or(LARGEST, |&cost| cost.into())
            }));
            for (cost, near) in values[starts[place(x, y)]..].iter_mut().zip(before.windows(3)) {
                let step = near[0].min(near[2]) + penalties.p1;
                let cheapest = near[1].min(step).min(least + p2);
                *cost = (u32::from(*cost) + cheapest - least) as u8;
            }
        }
    }
    CellVolume { table: costs.table.clone(), values }
}
