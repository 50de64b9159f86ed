//! The ranges of cells, from the definition.

use crate::{
    dense::{
        CellBand,
        cell_ranges::{LEAST, MARGIN, OUTLIERS, bin_bits},
        cells::{CELL, REACH},
    },
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::Plane,
};

/// For each cell of a picture what is to be searched of `range`: the index of the first disparity, and how many.
pub type CellPlane = Plane<(u32, u32)>;

/// The ranges of the cells of a picture of `size`, from the whole `map` of half the size.
pub fn cell_ranges(map: &DisparityMap, size: (u32, u32), range: DisparityRange) -> CellPlane {
    let band = CellBand::new(size, (0, size.1), range);
    let bits = bin_bits(band.map_range.count);
    let around = |cell: u32, end: u32| {
        let first = (cell * CELL / 2).saturating_sub(REACH / 2);
        first..((cell + 1) * CELL / 2 + REACH / 2).min(end)
    };
    Plane::from_fn(band.columns, band.rows, |column, row| {
        let (columns, rows) = (around(column, map.width()), around(row, map.height()));
        let pixels = columns.len() * rows.len();
        // The bins of the whole disparities, from the smallest to the largest.
        let mut bins: Vec<u32> = rows
            .flat_map(|y| columns.clone().map(move |x| map.get(x, y)))
            .filter(|&disparity| disparity != NONE)
            .map(|disparity| {
                let nearest = (disparity + SCALE / 2).div_euclid(SCALE);
                (nearest - band.map_range.min).clamp(0, band.map_range.count as i32 - 1) as u32 >> bits
            })
            .collect();
        bins.sort_unstable();
        if bins.is_empty() || 100 * bins.len() < LEAST as usize * pixels {
            return (0, range.count);
        }
        let wrong = bins.len() * OUTLIERS as usize / 100;
        let (low, high) = (bins[wrong], bins[bins.len() - 1 - wrong]);
        let lowest = band.map_range.min + (low << bits) as i32;
        let highest = band.map_range.min + ((high + 1) << bits) as i32 - 1;
        let index = |disparity: i32| (disparity - range.min).clamp(0, range.count as i32 - 1) as u32;
        let (first, last) = (index(2 * lowest - MARGIN as i32), index(2 * highest + MARGIN as i32));
        (first, last - first + 1)
    })
}
