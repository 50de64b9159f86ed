//! Selection of disparities by the summed costs of all paths through cells with ranges of their own, from the definition.

use rayon::prelude::*;

use super::{block_match::decide, cell_volume::CellVolume};
use crate::{
    dense::{Dense, DenseConfig},
    disparity::{NONE, SCALE},
    image::{Plane, Size},
};

/// The stage `select` and its winners among the disparities of each pixel's cell. A winner at an end of its
/// cell's range that is no end of the whole range is none: a smaller cost may lie beyond.
pub fn cell_select(paths: &[CellVolume], config: &DenseConfig) -> (Dense, Plane<Option<(u32, i32)>>) {
    let table = &paths[0].table;
    let (Size { width, .. }, count) = (table.size, table.range.count);
    let starts = CellVolume::starts(table);
    let selected: Vec<_> =
        (0..starts.len() - 1)
            .into_par_iter()
            .map_init(Vec::new, |sums: &mut Vec<Option<u32>>, pixel| {
                let cell = table.at(pixel as u32 % width, pixel as u32 / width);
                let disparities = cell.disparities();
                sums.clear();
                sums.extend((starts[pixel]..starts[pixel + 1]).zip(disparities.clone()).map(|(place, d)| {
                    (d < count).then(|| paths.iter().map(|path| u32::from(path.values[place])).sum())
                }));
                let sums_of = sums.iter().zip(disparities.clone());
                let winner = sums_of.filter_map(|(&sum, d)| Some((sum?, d))).min();
                match winner {
                    Some((cost, index)) if !cell.cuts_off(index, count) => {
                        let (disparity, confidence) = decide(sums, config);
                        let shift = disparities.start as i32 * SCALE;
                        let disparity = if disparity == NONE { NONE } else { disparity + shift };
                        (disparity, confidence, Some((cost, config.range.min + index as i32)))
                    }
                    _ => (NONE, 0, None),
                }
            })
            .collect();
    let at = |x: u32, y: u32| selected[(y * width + x) as usize];
    let dense = Dense {
        disparity: Plane::from_fn(table.size, |x, y| at(x, y).0),
        confidence: Plane::from_fn(table.size, |x, y| at(x, y).1),
    };
    (dense, Plane::from_fn(table.size, |x, y| at(x, y).2))
}
