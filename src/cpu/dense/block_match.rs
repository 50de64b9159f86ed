//! Block matching, from the definition.

use std::ops::Range;

use rayon::prelude::*;

use super::CellPlane;
use crate::{
    dense::{Dense, DenseConfig, FILLED, Interpolation, View, kernels::CELL},
    disparity::{DisparityMap, NONE, SCALE},
    image::{Luma, Size},
};

/// Columns whose costs are in memory at a time.
const COLUMNS: u32 = 256;

/// Memory of the costs of all threads, in bytes.
pub(super) fn bytes(config: &DenseConfig) -> u64 {
    let pixel = size_of::<Vec<Option<u32>>>() + config.range.count as usize * size_of::<Option<u32>>();
    rayon::current_num_threads() as u64 * u64::from(COLUMNS) * pixel as u64
}

/// The disparity of least cost for each pixel of `view`, unless its best rival is too close. Ties go to the smaller
/// disparity. With `ranges`, only the range of the pixel's cell is searched.
pub fn block_match(left: &Luma, right: &Luma, view: View, config: &DenseConfig, ranges: Option<&CellPlane>) -> Dense {
    let Size { width, .. } = left.size();
    let mut disparity = left.map(|_| NONE);
    let mut confidence = left.map(|_| 0);
    let disparities = disparity.data_mut().par_chunks_mut(width as usize);
    let confidences = confidence.data_mut().par_chunks_mut(width as usize);
    disparities.zip(confidences).enumerate().for_each(|(y, (disparities, confidences))| {
        for first in (0..width).step_by(COLUMNS as usize) {
            let columns = first..(first + COLUMNS).min(width);
            let mut costs = costs_of(left, right, view, (columns.clone(), y as u32), config);
            for (x, costs) in columns.zip(&mut costs) {
                if let Some((first, count)) = ranges.map(|ranges| ranges.get(x / CELL, y as u32 / CELL)) {
                    let searched = first as usize..(first + count) as usize;
                    costs
                        .iter_mut()
                        .enumerate()
                        .filter(|(index, _)| !searched.contains(index))
                        .for_each(|(_, c)| *c = None);
                }
                (disparities[x as usize], confidences[x as usize]) = decide(costs, config);
            }
        }
    });
    Dense { disparity, confidence }
}

/// The whole disparity of least cost for each pixel of `view`. Ties go to the smaller disparity.
pub fn winners(
    left: &Luma,
    right: &Luma,
    view: View,
    config: &DenseConfig,
    ranges: Option<&CellPlane>,
) -> DisparityMap {
    let config = config.clone().with(|parameters| {
        parameters.interpolation = Interpolation::None;
        parameters.uniqueness = 0;
    });
    block_match(left, right, view, &config, ranges).disparity
}

/// The cost of each pixel of row `y` in `columns` at each disparity of the range: the sum of absolute differences between
/// the windows around the pixel and around its partner, where edge pixels are repeated beyond the pictures. `None` where
/// the partner lies outside the other picture.
fn costs_of(
    left: &Luma,
    right: &Luma,
    view: View,
    (columns, y): (Range<u32>, u32),
    config: &DenseConfig,
) -> Vec<Vec<Option<u32>>> {
    let (width, radius, y) = (i64::from(left.width()), i64::from(config.parameters.radius()), i64::from(y));
    let columns = i64::from(columns.start)..i64::from(columns.end);
    let (reference, searched, direction) = match view {
        View::Left => (left, right, -1),
        View::Right => (right, left, 1),
    };
    let mut costs = vec![vec![None; config.range.count as usize]; (columns.end - columns.start) as usize];
    for index in 0..config.range.count {
        let shift = direction * (i64::from(config.range.min) + i64::from(index));
        // One column of a window; windows of neighbouring pixels share all columns but two.
        let column = |x: i64| -> u32 {
            let difference = |row| reference.get_clamped(x, row).abs_diff(searched.get_clamped(x + shift, row));
            (y - radius..=y + radius).map(|row| u32::from(difference(row))).sum()
        };
        // First and last of the pixels with a partner in the picture.
        let first = (-shift).max(columns.start);
        let last = (width - 1 - shift.max(0)).min(columns.end - 1);
        let sums: Vec<u32> = (first - radius..=last + radius).map(column).collect();
        for (x, window) in (first..=last).zip(sums.windows(config.parameters.window() as usize)) {
            costs[(x - columns.start) as usize][index as usize] = Some(window.iter().sum());
        }
    }
    costs
}

/// Selects the fixed-point disparity and the confidence of a pixel from its costs.
pub(super) fn decide(costs: &[Option<u32>], config: &DenseConfig) -> (i32, u8) {
    let candidates = || costs.iter().enumerate().filter_map(|(index, &cost)| Some((cost?, index)));
    let Some((best, winner)) = candidates().min() else {
        return (NONE, 0);
    };
    let rival = candidates().filter(|&(_, index)| index.abs_diff(winner) > 1).map(|(cost, _)| cost).min();
    let unique = |rival| config.parameters.uniqueness == 0 || 100 * rival > (100 + config.parameters.uniqueness) * best;
    if !rival.is_none_or(unique) {
        return (NONE, 0);
    }
    let neighbour = |index: Option<usize>| costs.get(index?).copied().flatten();
    let between = match (neighbour(winner.checked_sub(1)), neighbour(winner.checked_add(1))) {
        (Some(below), Some(above)) => interpolate(below, best, above, config.parameters.interpolation),
        _ => 0,
    };
    let confidence = match rival {
        Some(rival) if rival > 0 => 1 + 254 * (rival - best) / rival,
        _ => 1,
    };
    let confidence = confidence.max(u32::from(FILLED) + 1);
    ((config.range.min + winner as i32) * SCALE + between, confidence as u8)
}

/// Sub-pixel position of the minimum, in 1/256 px from the winner.
fn interpolate(below: u32, best: u32, above: u32, interpolation: Interpolation) -> i32 {
    let (left, right) = (i64::from(below - best), i64::from(above - best));
    let divisor = match interpolation {
        Interpolation::None => return 0,
        Interpolation::Parabola => left + right,
        Interpolation::Equiangular => left.max(right),
    };
    if divisor == 0 {
        return 0;
    }
    // The nearest integer to 128 (left - right) / divisor, halves up.
    (2 * 128 * (left - right) + divisor).div_euclid(2 * divisor) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::DisparityRange;

    fn config(min: i32, count: u32) -> DenseConfig {
        DenseConfig::new(DisparityRange::new(min, count).unwrap())
    }

    #[test]
    fn a_cost_by_hand() {
        // 3x3 windows around (0, 0) and (1, 0) of a single row, with repeated edge pixels: 5 5 9 against 5 9 2, three
        // times.
        let row = Luma::new((3, 1), vec![5, 9, 2]).unwrap();
        let costs = costs_of(&row, &row, View::Left, (0..3, 0), &config(-1, 1).with_window(3));
        assert_eq!(costs[0], [Some(3 * (4 + 7))]);
    }

    #[test]
    fn ties_go_to_the_smaller_disparity() {
        let flat = Luma::filled((5, 3), 7);
        let dense = block_match(&flat, &flat, View::Left, &config(-1, 3), None);
        // The first column has no partner at disparity 1, the last none at -1.
        assert_eq!(dense.disparity.row(1), [-SCALE, -SCALE, -SCALE, -SCALE, 0]);
    }

    #[test]
    fn the_rival_is_no_neighbour_of_the_winner() {
        let c = config(0, 4).with(|parameters| parameters.uniqueness = 50);
        assert_eq!(decide(&[Some(10), Some(11), Some(99), Some(20)], &c).0, 0);
        assert_eq!(decide(&[Some(10), Some(11), Some(99), Some(15)], &c).0, NONE);
        // 1 + 254 * (20 - 10) / 20
        assert_eq!(decide(&[Some(10), Some(11), Some(99), Some(20)], &c).1, 128);
    }

    #[test]
    fn interpolation_by_hand() {
        // Parabola through 30, 10, 20: vertex at (30 - 20) / (2 * 30) = 1/6 px = 42.67 / 256.
        assert_eq!(interpolate(30, 10, 20, Interpolation::Parabola), 43);
        assert_eq!(interpolate(20, 10, 30, Interpolation::Parabola), -43);
        // Equal slopes of 20 per pixel: (30 - 20) / (2 * 20) = 1/4 px.
        assert_eq!(interpolate(30, 10, 20, Interpolation::Equiangular), 64);
        // A half goes up: 128 * -3 / 256 = -1.5.
        assert_eq!(interpolate(10 + 253, 10, 10 + 256, Interpolation::Equiangular), -1);
        assert_eq!(interpolate(10, 10, 10, Interpolation::Parabola), 0);
    }

    #[test]
    fn both_views_see_one_shift() {
        let left = Luma::from_fn((24, 8), |x, y| ((x * 37 + y * 91).wrapping_mul(2_654_435_761) >> 13) as u8);
        let right = Luma::from_fn((24, 8), |x, y| left.get_clamped(i64::from(x) + 3, i64::from(y)));
        let of_left = winners(&left, &right, View::Left, &config(0, 8), None);
        let of_right = winners(&left, &right, View::Right, &config(0, 8), None);
        assert!((6..20).all(|x| of_left.get(x, 4) == 3 * SCALE), "{:?}", of_left.row(4));
        assert!((3..17).all(|x| of_right.get(x, 4) == 3 * SCALE), "{:?}", of_right.row(4));
    }
}
