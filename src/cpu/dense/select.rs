//! From the costs of all paths to disparities, from the definition.

use super::block_match::decide;
use crate::{
    dense::{Dense, DenseConfig},
    image::{Plane, Size},
};

/// For each of `size` pixels the least sum of the costs on all `paths`, and its disparity in pixels; ties go to the smaller
/// one.
pub fn path_winners(
    paths: &[Vec<u8>],
    Size { width, height }: Size,
    config: &DenseConfig,
) -> Plane<Option<(u32, i32)>> {
    let count = config.range.count.next_multiple_of(4) as usize;
    Plane::from_fn((width, height), |x, y| {
        let pixel = (y * width + x) as usize * count;
        let sum = |d: usize| paths.iter().map(|path| u32::from(path[pixel + d])).sum();
        (0..config.range.count as usize).map(|d| (sum(d), config.range.min + d as i32)).min()
    })
}

/// For each of `size` pixels the disparity whose costs on all `paths` add up to the least, unless its best rival is too
/// close. Ties go to the smaller disparity.
pub fn select(paths: &[Vec<u8>], Size { width, height }: Size, config: &DenseConfig) -> Dense {
    let count = config.range.count.next_multiple_of(4) as usize;
    let answers: Vec<(i32, u8)> = (0..width as usize * height as usize)
        .map(|pixel| {
            let sum = |d| Some(paths.iter().map(|path| u32::from(path[pixel * count + d])).sum());
            let sums: Vec<Option<u32>> = (0..config.range.count as usize).map(sum).collect();
            decide(&sums, config)
        })
        .collect();
    let at = |x: u32, y: u32| answers[(y * width + x) as usize];
    Dense {
        disparity: Plane::from_fn((width, height), |x, y| at(x, y).0),
        confidence: Plane::from_fn((width, height), |x, y| at(x, y).1),
    }
}
