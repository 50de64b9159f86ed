//! Where a picture is cut into bands, by the memory that they take.

use super::bands::Task;
use crate::{
    dense::{CostAggregation, CrossCheck, DenseConfig, pyramid::CellTable},
    disparity::DisparityRange,
    error::Result,
    image::Size,
    memory::{self, Left},
};

/// Bytes per pixel of a band beside its volumes: census transforms, places in volumes, winners, the map and what is made on the
/// way to it.
const AROUND: u64 = 128;

/// Bytes per pixel of a map.
const MAP: u64 = 5;

/// Most memory of bands, in bytes, where it suffices: wider bands are no faster.
const BANDS: u64 = 1 << 27;

/// Most memory of a picture in one band, in bytes, which is faster than several: costs are computed once, and no path is followed
/// twice.
const ONE_BAND: u64 = 1 << 29;

/// How a picture is cut into bands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Rows of a band; the last band can have fewer.
    pub rows: u32,
    /// Parts into which a picture of more bands is cut, and each of them again, at least 2.
    pub parts: u32,
}

impl Cut {
    /// The bands of a picture for the memory that is left.
    ///
    /// # Errors
    /// [`crate::Error::NotEnoughMemory`] if that does not hold even the map and the narrowest bands.
    pub(super) fn fitting(task: Task<'_>) -> Result<Self> {
        let (left, size) = (Left::now(), task.left.size());
        let memory = Memory::new(size, task.config, task.costs, task.table);
        let map = MAP * size.pixels();
        let room = left.map_or(u64::MAX, |left| left.bytes.saturating_sub(map));
        let cut = memory.cut(room);
        check(map + memory.of(cut), left, size, task.config)?;
        Ok(cut)
    }
}

/// Refuses what needs more than the memory that is left.
///
/// # Errors
/// [`crate::Error::NotEnoughMemory`].
pub(super) fn check(needed: u64, left: Option<Left>, size: Size, config: &DenseConfig) -> Result<()> {
    let what = || format!("matching {size} pixels over {} disparities on the CPU", config.range.count);
    memory::check(needed, left, what, "search fewer disparities, scale the pictures down, or raise the limit")
}

/// The memory that bands of a picture take.
struct Memory {
    height: u32,
    width: u64,
    radius: u64,
    paths: u64,
    /// Paths that are followed at a time.
    threads: u64,
    /// The largest row of a volume, and a volume of the picture, in bytes.
    row: u64,
    all: u64,
    /// Rows from which paths from above enter, in bytes.
    above: u64,
    /// The rows that are kept per part for the paths from below, in bytes.
    kept_row: u64,
}

impl Memory {
    fn new(size: Size, config: &DenseConfig, costs: &CostAggregation, table: Option<&CellTable>) -> Self {
        let width = u64::from(size.width);
        let (row, all) = match table {
            None => {
                let row = width * u64::from(DisparityRange::padded(config.range.count));
                (row, row * u64::from(size.height))
            }
            Some(table) => {
                let rows = || (0..size.height).map(|y| 4 * table.row_words(y));
                (rows().max().unwrap_or(0), rows().sum())
            }
        };
        let searched = costs.cross_check == CrossCheck::Searched && config.parameters.consistency.is_some();
        let views = if searched { 2 } else { 1 };
        let directions = costs.directions();
        let rows = |dy| views * row * directions.iter().filter(|direction| direction.dy == dy).count() as u64;
        let paths = directions.len() as u64;
        let threads = paths.min(rayon::current_num_threads() as u64);
        let (radius, height) = (costs.radius().into(), size.height);
        Self { height, width, radius, paths, threads, row, all, above: rows(1), kept_row: rows(-1) }
    }

    /// One band, or bands as wide as makes them fast, whose memory, with that of the rows kept for the paths from below, is at
    /// most `left` bytes; or the narrowest bands, where even those take more.
    fn cut(&self, left: u64) -> Cut {
        let one = Cut { rows: self.height, parts: 2 };
        if self.of(one) <= left.min(ONE_BAND) {
            return one;
        }
        let usual = self.widest(left.min(BANDS), self.height);
        // The costs of its halo are computed again for each band.
        let least = self.height.min(2 * self.radius as u32);
        if usual.rows < least { self.widest(left, least) } else { usual }
    }

    /// The widest bands of at most `rows` rows whose memory is within `limit`, or bands of one row.
    fn widest(&self, limit: u64, rows: u32) -> Cut {
        let narrowest = |rows| Cut { rows, parts: 2 };
        // Half remains for the rows of more parts, which save sweeps from bottom to top.
        let for_bands = if self.kept_row > 0 { limit / 2 } else { limit };
        let rows = partition_point(rows, |rows| self.of(narrowest(rows)) <= for_bands).max(1);
        let bands = self.height.div_ceil(rows);
        let cuts = (1..).map(|levels| Cut { rows, parts: root(bands, levels) });
        cuts.take_while(|cut| cut.parts > 2).find(|&cut| self.of(cut) <= limit).unwrap_or(narrowest(rows))
    }

    /// The memory of all bands.
    fn of(&self, cut: Cut) -> u64 {
        let (mut bands, mut kept) = (self.height.div_ceil(cut.rows), 0);
        while bands > 1 {
            kept += u64::from(cut.parts.min(bands) - 1);
            bands = bands.div_ceil(cut.parts);
        }
        self.band(cut.rows.min(self.height)) + kept * self.kept_row
    }

    /// The memory of a band of `rows` rows. While costs are averaged there are four volumes; while paths are followed,
    /// the costs, the costs along each path, and per thread the costs with the row from which its path enters.
    fn band(&self, rows: u32) -> u64 {
        let rows = u64::from(rows);
        let volume = |rows: u64| (rows * self.row).min(self.all);
        let costs = if self.radius > 0 { 4 } else { 1 } * volume(rows + 2 * self.radius);
        let following = volume(rows) + (self.paths + self.threads) * volume(rows + 1);
        costs.max(following) + self.above + AROUND * self.width * (rows + 2 * (self.radius + 6))
    }
}

/// The largest number up to `most` that `holds`, which holds for all numbers below one that holds; 0 if none does.
fn partition_point(most: u32, holds: impl Fn(u32) -> bool) -> u32 {
    let (mut low, mut high) = (0, most);
    while low < high {
        let middle = high - (high - low) / 2;
        if holds(middle) { low = middle } else { high = middle - 1 }
    }
    low
}

/// The smallest number whose power of `levels` is at least `count`.
fn root(count: u32, levels: u32) -> u32 {
    (1..).find(|parts: &u32| u64::from(*parts).saturating_pow(levels) >= u64::from(count)).unwrap_or(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        dense::{Paths, SemiGlobal, pyramid::CellRange},
        disparity::DisparityRange,
        image::Plane,
    };

    fn along(paths: Paths) -> CostAggregation {
        let semi_global = Some(SemiGlobal { paths, ..SemiGlobal::TUNED });
        CostAggregation { semi_global, ..CostAggregation::TUNED }
    }

    #[test]
    fn bands_are_as_wide_as_their_memory_lets_them() {
        let (size, config) = (Size::new(8660, 5774), DenseConfig::new(DisparityRange::new(0, 256).unwrap()));
        for paths in Paths::ALL {
            let memory = Memory::new(size, &config, &along(paths), None);
            let mut before = 0;
            for limit in [1 << 27, 1 << 29, 1 << 31] {
                let cut = memory.widest(limit, size.height);
                assert!(
                    memory.of(cut) <= limit || cut.rows == 1,
                    "{paths}: {cut:?} takes {} of {limit}",
                    memory.of(cut)
                );
                assert!(cut.rows > before, "{paths}: {cut:?}");
                before = cut.rows;
            }
            assert_eq!(memory.cut(1 << 31), memory.widest(BANDS, size.height));
        }
    }

    #[test]
    fn little_pictures_are_one_band_and_little_memory_gives_one_row() {
        let (size, config) = (Size::new(64, 48), DenseConfig::new(DisparityRange::new(0, 16).unwrap()));
        for paths in Paths::ALL {
            let memory = Memory::new(size, &config, &along(paths), None);
            assert_eq!(memory.cut(u64::MAX).rows, 48);
            assert_eq!(memory.cut(0), Cut { rows: 1, parts: 2 });
        }
    }

    #[test]
    fn cells_count_as_their_ranges_are_wide() {
        let (size, range) = (Size::new(70, 96), DisparityRange::new(0, 256).unwrap());
        let whole = CellTable::whole(size, range);
        let cells = Plane::from_fn(whole.cells.size(), |_, y| CellRange { first: 0, words: [16, 4, 64][y as usize] });
        let memory =
            Memory::new(size, &DenseConfig::new(range), &along(Paths::Three), Some(&CellTable { cells, ..whole }));
        assert_eq!((memory.row, memory.all), (70 * 256, 32 * 70 * (64 + 16 + 256)));
    }

    #[test]
    fn halos_are_no_larger_than_their_bands_where_memory_lets_them() {
        let (size, config) = (Size::new(8660, 5774), DenseConfig::new(DisparityRange::new(0, 256).unwrap()));
        let averaged = CostAggregation { window: 31, ..CostAggregation::TUNED };
        let memory = Memory::new(size, &config, &averaged, None);
        assert_eq!(memory.cut(1 << 30).rows, 30);
        assert!(memory.cut(1 << 28).rows < 30);
    }

    #[test]
    fn roots_by_hand() {
        assert_eq!((root(9, 2), root(10, 2), root(722, 1), root(722, 2), root(1, 3)), (3, 4, 722, 27, 1));
        assert_eq!([0, 3, 9].map(|most| partition_point(9, |n| n <= most)), [0, 3, 9]);
    }

    #[test]
    fn what_memory_cannot_hold_is_refused_with_a_way_out() {
        let config = DenseConfig::new(DisparityRange::new(0, 64).unwrap());
        let left = Some(Left { bytes: 5 << 20, by: "the machine" });
        let error = check(6 << 20, left, Size::new(640, 480), &config).unwrap_err();
        assert_eq!(
            error.to_string(),
            "matching 640x480 pixels over 64 disparities on the CPU needs 6 MiB of memory, and the machine leaves 5 MiB: \
             search fewer disparities, scale the pictures down, or raise the limit"
        );
    }
}
