//! Mean-shift filtering, from the definition.

use rayon::prelude::*;

use crate::{
    image::{Plane, Size},
    kamencay::{ModeSeeking, kernels::STILL},
};

/// The colour of each pixel's mode, the point to which it climbs: red, green and blue, from the lowest byte of a `u32`
/// on.
pub fn mean_shift(pixels: &Plane<u32>, seeking: &ModeSeeking) -> Plane<u32> {
    let Size { width, height } = pixels.size();
    let modes: Vec<u32> = (0..width * height)
        .into_par_iter()
        .map(|pixel| {
            let mut point = at(pixels, pixel % width, pixel / width);
            for _ in 0..seeking.turns {
                let Some(mean) = mean_around(pixels, point, seeking) else { break };
                let shift: i32 = (0..5).map(|axis| (mean[axis] - point[axis]).abs()).sum();
                point = mean;
                if shift <= STILL {
                    break;
                }
            }
            let [_, _, red, green, blue] = point.map(|value| ((value + 8) >> 4) as u8);
            u32::from_le_bytes([red, green, blue, 0])
        })
        .collect();
    Plane::from_fn((width, height), |x, y| modes[(y * width + x) as usize])
}

/// Column, row, red, green and blue, in 1/16.
type Point = [i32; 5];

fn at(pixels: &Plane<u32>, x: u32, y: u32) -> Point {
    let [red, green, blue, _] = pixels.get(x, y).to_le_bytes().map(i32::from);
    [x as i32, y as i32, red, green, blue].map(|value| 16 * value)
}

/// The mean of the pixels of similar colour in a window around the pixel nearest to `point`, rounded to 1/16, halves
/// up; `None` without any such pixel.
fn mean_around(pixels: &Plane<u32>, point: Point, seeking: &ModeSeeking) -> Option<Point> {
    let radius = seeking.radius as i32;
    let span = |centre: i32, count: u32| {
        let centre = (centre + 8) >> 4;
        ((centre - radius).max(0) as u32)..=((centre + radius).min(count as i32 - 1) as u32)
    };
    let columns = span(point[0], pixels.width());
    let (mut sums, mut count) = ([0_i64; 5], 0);
    for y in span(point[1], pixels.height()) {
        for x in columns.clone() {
            let other = at(pixels, x, y);
            let squared: i32 = (2..5).map(|channel| (other[channel] - point[channel]).pow(2)).sum();
            if squared <= (16 * seeking.range as i32).pow(2) {
                count += 1;
                (0..5).for_each(|axis| sums[axis] += i64::from(other[axis]));
            }
        }
    }
    (count > 0).then(|| sums.map(|sum| (2 * sum + count).div_euclid(2 * count) as i32))
}
