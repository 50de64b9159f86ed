//! A path of semi-global matching, from the definition.

use crate::{
    dense::{Direction, Penalties},
    image::Plane,
};

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
    for &y in &ordered(height, direction.dy) {
        for &x in &ordered(width, direction.dx) {
            let (qx, qy) = (x - i64::from(direction.dx), y - i64::from(direction.dy));
            if !(0..width).contains(&qx) || !(0..height).contains(&qy) {
                continue;
            }
            let p2 = penalties.p2_at(luma(x, y).abs_diff(luma(qx, qy)));
            let before: Vec<u32> = out[place(qx, qy)..][..count].iter().map(|&cost| cost.into()).collect();
            let least = before.iter().copied().min().unwrap_or(0);
            for d in 0..count {
                let stay = before[d];
                let neighbours = [d.checked_sub(1), Some(d + 1)].into_iter().flatten();
                let step = neighbours.filter_map(|n| before.get(n)).map(|cost| cost + penalties.p1).min();
                let cheapest = stay.min(least + p2).min(step.unwrap_or(u32::MAX));
                let cost = &mut out[place(x, y) + d];
                *cost = (u32::from(*cost) + cheapest - least) as u8;
            }
        }
    }
    out
}
