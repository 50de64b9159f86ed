//! A path of semi-global matching, from the definition.

use crate::{
    dense::{Direction, Penalties},
    image::Plane,
};

/// A cost above every other, to which a penalty can be added.
const NO_COST: u32 = u32::MAX / 2;

/// The path costs of each pixel of `reference` and disparity, in the layout of `costs` (Hirschmueller, PAMI 2008).
pub fn path(reference: &Plane<u32>, costs: &[u8], penalties: &Penalties, direction: Direction) -> Vec<u8> {
    let (width, height) = (i64::from(reference.width()), i64::from(reference.height()));
    let count = costs.len() / (width * height) as usize;
    let place = |x: i64, y: i64| (y * width + x) as usize * count;
    let luma = |x: i64, y: i64| reference.get(x as u32, y as u32) & 255;
    let ordered = |length: i64, step: i32| -> Vec<i64> {
        if step < 0 { (0..length).rev().collect() } else { (0..length).collect() }
    };
    let mut out = costs.to_vec();
    // Costs of the pixel before on the path, between two that no disparity has.
    let mut before = vec![NO_COST; count + 2];
    for &y in &ordered(height, direction.dy) {
        for &x in &ordered(width, direction.dx) {
            let (qx, qy) = (x - i64::from(direction.dx), y - i64::from(direction.dy));
            if !(0..width).contains(&qx) || !(0..height).contains(&qy) {
                continue;
            }
            let p2 = penalties.p2_at(luma(x, y).abs_diff(luma(qx, qy)));
            let costs_before = &out[place(qx, qy)..][..count];
            before[1..=count].iter_mut().zip(costs_before).for_each(|(before, &cost)| *before = cost.into());
            let least = before[1..=count].iter().copied().min().unwrap_or(0);
            for (cost, near) in out[place(x, y)..][..count].iter_mut().zip(before.windows(3)) {
                let step = near[0].min(near[2]) + penalties.p1;
                let cheapest = near[1].min(step).min(least + p2);
                *cost = (u32::from(*cost) + cheapest - least) as u8;
            }
        }
    }
    out
}
