//! The ranges of cells, from the definition.

use crate::{
    dense::kernels::{BLOCK, CELL, CellBand, LEAST, MARGIN, REACH},
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::{Plane, Size},
};

/// The searched part of a range per cell: the index of the first disparity, and the number of disparities.
pub type CellPlane = Plane<(u32, u32)>;

/// The ranges of the cells of a picture of `size`, from the complete half-size `map`.
pub fn cell_ranges(map: &DisparityMap, size: Size, range: DisparityRange) -> CellPlane {
    let band = CellBand::new(size, (0, size.height), range);
    let around = |cell: u32, end: u32| {
        let first = (cell * CELL / 2).saturating_sub(REACH / 2);
        first..((cell + 1) * CELL / 2 + REACH / 2).min(end)
    };
    Plane::from_fn((band.columns, band.rows), |column, row| {
        let (columns, rows) = (around(column, map.width()), around(row, map.height()));
        let pixels = columns.len() * rows.len();
        let blocks =
            rows.step_by(BLOCK as usize).flat_map(|y| columns.clone().step_by(BLOCK as usize).map(move |x| (x, y)));
        let blocks: Vec<Vec<i32>> = blocks.map(|(x, y)| block(map, x, y)).collect();
        let known: usize = blocks.iter().map(Vec::len).sum();
        // The third smallest and the third largest disparity of each block, in either order.
        let extremes =
            || blocks.iter().filter_map(|block| Some([*block.get(2)?, *block.iter().nth_back(2)?])).flatten();
        let (low, high) = (extremes().min(), extremes().max());
        match (low, high) {
            (Some(low), Some(high)) if 100 * known >= LEAST as usize * pixels => {
                let index = |disparity: i32| (disparity - range.min).clamp(0, range.count as i32 - 1) as u32;
                let (first, last) = (index(2 * low - MARGIN as i32), index(2 * high + MARGIN as i32));
                (first, last - first + 1)
            }
            _ => (0, range.count),
        }
    })
}

/// The disparities of a block, rounded to whole pixels, in ascending order.
fn block(map: &DisparityMap, left: u32, top: u32) -> Vec<i32> {
    let (columns, rows) = (left..(left + BLOCK).min(map.width()), top..(top + BLOCK).min(map.height()));
    let disparities = rows.flat_map(|y| columns.clone().map(move |x| map.get(x, y)));
    let mut known: Vec<i32> = disparities.filter(|&d| d != NONE).map(|d| (d + SCALE / 2).div_euclid(SCALE)).collect();
    known.sort_unstable();
    known
}
