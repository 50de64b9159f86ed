//! Selection of disparities by the summed costs of all paths, from the definition.

use rayon::prelude::*;

use super::block_match::decide;
use crate::{
    dense::{Dense, DenseConfig},
    disparity::DisparityRange,
    image::{Plane, Size},
};

/// The winner of each pixel: the least sum of its costs on all `paths`, and the disparity in pixels; ties go to the
/// smaller disparity.
pub fn path_winners(
    paths: &[Vec<u8>],
    Size { width, height }: Size,
    config: &DenseConfig,
) -> Plane<Option<(u32, i32)>> {
    let count = DisparityRange::padded(config.range.count) as usize;
    Plane::from_fn((width, height), |x, y| {
        let pixel = (y * width + x) as usize * count;
        let sum = |d: usize| paths.iter().map(|path| u32::from(path[pixel + d])).sum();
        (0..config.range.count as usize).map(|d| (sum(d), config.range.min + d as i32)).min()
    })
}

/// The disparity of each pixel with the least sum of costs on all `paths`, unless its best rival is too close. Ties go
/// to the smaller disparity.
pub fn select(paths: &[Vec<u8>], Size { width, height }: Size, config: &DenseConfig) -> Dense {
    let count = DisparityRange::padded(config.range.count) as usize;
    let selected: Vec<(i32, u8)> = (0..width as usize * height as usize)
        .into_par_iter()
        .map_init(Vec::new, |sums, pixel| {
            let sum = |d| Some(paths.iter().map(|path| u32::from(path[pixel * count + d])).sum());
            sums.clear();
            sums.extend((0..config.range.count as usize).map(sum));
            decide(sums, config)
        })
        .collect();
    let at = |x: u32, y: u32| selected[(y * width + x) as usize];
    Dense {
        disparity: Plane::from_fn((width, height), |x, y| at(x, y).0),
        confidence: Plane::from_fn((width, height), |x, y| at(x, y).1),
    }
}
