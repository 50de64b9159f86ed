//! The disparities of each cell of a level.

use std::ops::Range;

use crate::{
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::{Plane, Size},
};

/// Side of a cell, in pixels. A cell's range also covers the cells around it.
pub const SIDE: u32 = 32;

/// Disparities added at either end of a cell's range, in pixels: rounding of the half-size disparities, and a rival
/// beside the winner.
pub const MARGIN: i32 = 2;

/// Words of four disparities in a step of the number of disparities: sixteen disparities.
const GRAIN: u32 = 4;

/// The searched disparities of a cell, in words of four disparities from the smallest of the whole range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellRange {
    /// The first word.
    pub first: u32,
    /// Number of words, a multiple of four.
    pub words: u32,
}

/// The searched disparities of all cells of a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellTable {
    /// Width and height of the level, in pixels.
    pub size: Size,
    /// The whole range.
    pub range: DisparityRange,
    /// The cells, each a part of the whole range rounded up to whole sixteens.
    pub cells: Plane<CellRange>,
    /// Rows of the uppermost cells that lie above the first row of pixels: 0 for a whole level.
    pub above: u32,
}

impl CellRange {
    /// The whole of a range of `count` disparities.
    pub fn whole(count: u32) -> Self {
        Self { first: 0, words: DisparityRange::padded(count) / 4 }
    }

    /// The cell range of a range of `count` disparities that holds the disparities number `low` to `high`, with what is
    /// more spread evenly over both ends.
    fn around(low: u32, high: u32, count: u32) -> Self {
        let whole = Self::whole(count).words;
        let least = (high / 4 + 1 - low / 4).next_multiple_of(GRAIN);
        // The middle of the range is that of the disparities, to half a word.
        let words = least.min(whole);
        let first = ((low + high + 1).saturating_sub(4 * words) / 2).div_ceil(4);
        // All words that hold disparities, within the whole range.
        let first = first.max((high / 4 + 1).saturating_sub(words)).min(low / 4).min(whole - words);
        Self { first, words }
    }

    /// Number of the first disparity of the whole range, and number behind the last.
    pub fn disparities(&self) -> Range<u32> {
        4 * self.first..4 * (self.first + self.words)
    }

    /// Whether disparity number `index` of a range of `count` is at an end of the cell's range that is no end of the whole
    /// range.
    pub fn cuts_off(&self, index: u32, count: u32) -> bool {
        let own = self.disparities();
        index == own.start && index > 0 || index + 1 == own.end && index + 1 < count
    }
}

impl CellTable {
    /// The whole range for all cells of a level of `size`.
    pub fn whole(size: Size, range: DisparityRange) -> Self {
        Self { size, range, cells: Plane::filled(cells_of(size), CellRange::whole(range.count)), above: 0 }
    }

    /// The cells of a level of `size`, from the complete map of the level above, of half the size.
    pub fn below(map: &DisparityMap, size: Size, range: DisparityRange) -> Self {
        let bounds = nearest(around(&of_cells(map, cells_of(size))));
        let index = |disparity: i32| (disparity - range.min).clamp(0, range.count as i32 - 1) as u32;
        let cell = |bounds: &Option<[i32; 2]>| match bounds {
            None => CellRange::whole(range.count),
            Some([low, high]) => CellRange::around(
                index((2 * low).div_euclid(SCALE) - MARGIN),
                index(-(-2 * high).div_euclid(SCALE) + MARGIN),
                range.count,
            ),
        };
        Self { size, range, cells: bounds.map(cell), above: 0 }
    }

    /// The table of the given rows.
    pub fn cut(&self, rows: Range<u32>) -> Self {
        let (first, end) = (rows.start + self.above, rows.end + self.above);
        Self {
            size: Size::new(self.size.width, rows.end - rows.start),
            range: self.range,
            cells: self.cells.cut(first / SIDE..end.div_ceil(SIDE)),
            above: first % SIDE,
        }
    }

    /// The cell of a pixel.
    pub fn at(&self, x: u32, y: u32) -> CellRange {
        self.cells.get(x / SIDE, (y + self.above) / SIDE)
    }

    /// Words of row `y` of the pixels.
    pub fn row_words(&self, y: u32) -> u64 {
        let width = |column: u32| SIDE.min(self.size.width - SIDE * column);
        (0..)
            .zip(self.cells.row((y + self.above) / SIDE))
            .map(|(column, cell)| u64::from(cell.words * width(column)))
            .sum()
    }

    /// Pixel-disparities of all cells, as a share of those of the whole range, 0 to 1 and a little more.
    pub fn share(&self) -> f64 {
        let words: u64 = (0..self.size.height).map(|y| self.row_words(y)).sum();
        4.0 * words as f64 / self.size.pixels() as f64 / f64::from(self.range.count)
    }
}

/// Cells per row, and rows of cells.
fn cells_of(size: Size) -> Size {
    Size::new(size.width.div_ceil(SIDE), size.height.div_ceil(SIDE))
}

/// Smallest and largest disparity, in 1/256 px.
type Bounds = Option<[i32; 2]>;

fn union(a: Bounds, b: Bounds) -> Bounds {
    match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (a, b) => a.or(b),
    }
}

/// The bounds of each cell alone, in a map of half the size.
fn of_cells(map: &DisparityMap, cells: Size) -> Plane<Bounds> {
    let half = SIDE / 2;
    Plane::from_fn(cells, |column, row| {
        let rows = half * row..(half * (row + 1)).min(map.height());
        let columns = half * column..(half * (column + 1)).min(map.width());
        let pixels = rows.flat_map(|y| map.row(y)[columns.start as usize..columns.end as usize].iter());
        pixels.filter(|&&d| d != NONE).fold(None, |bounds, &d| union(bounds, Some([d; 2])))
    })
}

/// The bounds of each cell and of the eight cells around it.
fn around(bounds: &Plane<Bounds>) -> Plane<Bounds> {
    Plane::from_fn(bounds.size(), |x, y| {
        let near = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i64::from(x) + i, i64::from(y) + j)));
        near.fold(None, |all, (x, y)| union(all, bounds.get_clamped(x, y)))
    })
}

/// The bounds of each cell; those of the nearest cells where it has none.
fn nearest(mut bounds: Plane<Bounds>) -> Plane<Bounds> {
    while bounds.data().iter().any(Option::is_none) && bounds.data().iter().any(Option::is_some) {
        let wider = around(&bounds);
        bounds = Plane::from_fn(bounds.size(), |x, y| bounds.get(x, y).or(wider.get(x, y)));
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_range_by_hand() {
        let around = |low, high, count| {
            let CellRange { first, words } = CellRange::around(low, high, count);
            (first, words)
        };
        // 40 to 43 is one word; four words, the middle at 42: 34 to 50, from a multiple of four.
        assert_eq!(around(40, 43, 200), (9, 4));
        // 39 to 54 touches five words: 32 disparities.
        assert_eq!(around(39, 54, 200), (8, 8));
        // At the ends of the whole range, 208 with what fills the sixteens.
        assert_eq!(around(0, 3, 200), (0, 4));
        assert_eq!(around(196, 199, 200), (48, 4));
        assert_eq!(around(0, 199, 200), (0, 52));
        assert_eq!(around(0, 0, 1), (0, 4));
    }

    #[test]
    fn every_cell_range_holds_its_disparities() {
        for count in [1, 15, 16, 17, 50, 64, 95] {
            let whole = CellRange::whole(count);
            for high in 0..count {
                for low in 0..=high {
                    let cell = CellRange::around(low, high, count);
                    let own = cell.disparities();
                    assert!(own.contains(&low) && own.contains(&high), "{low} to {high} of {count}: {cell:?}");
                    assert!(own.end <= whole.disparities().end && cell.words.is_multiple_of(GRAIN));
                }
            }
        }
    }

    #[test]
    fn ends_of_a_cell_are_not_ends_of_the_range() {
        let cell = CellRange { first: 4, words: 4 };
        assert_eq!([15, 16, 17, 30, 31].map(|index| cell.cuts_off(index, 40)), [false, true, false, false, true]);
        assert!(!cell.cuts_off(31, 32), "the last of the whole range");
        assert!(!CellRange::whole(20).cuts_off(0, 20) && !CellRange::whole(20).cuts_off(19, 20));
    }

    #[test]
    fn cells_see_their_neighbours_or_the_nearest() {
        // Four columns of cells, 16 px each in the half-size map, and a part of a fifth; disparities in two of them.
        let map = Plane::from_fn((70, 10), |x, _| match x {
            3 => 10 * SCALE,
            20 => 20 * SCALE + 1,
            _ => NONE,
        });
        let range = DisparityRange::new(-4, 100).unwrap();
        let table = CellTable::below(&map, Size::new(140, 20), range);
        assert_eq!(table.cells.size(), Size::new(5, 1));
        // 18 to 43 px in the first two, 38 to 43 in the third, and from there in the others.
        let expected = [(18 + 4, 43 + 4), (18 + 4, 43 + 4), (38 + 4, 43 + 4), (38 + 4, 43 + 4), (38 + 4, 43 + 4)];
        assert_eq!(table.cells.data(), expected.map(|(low, high)| CellRange::around(low, high, 100)));
        assert_eq!(table.row_words(0), 2 * 32 * 8 + 2 * 32 * 4 + 12 * 4);
        assert_eq!(table.share(), table.row_words(0) as f64 * 4.0 / 140.0 / 100.0);
        let blind = CellTable::below(&map.map(|_| NONE), Size::new(140, 20), range);
        assert_eq!(blind, CellTable::whole(Size::new(140, 20), range));
    }

    #[test]
    fn rows_are_cut_out_of_cells() {
        let whole = CellTable::whole(Size::new(40, 100), DisparityRange::new(0, 64).unwrap());
        let cells = Plane::from_fn(whole.cells.size(), |x, y| CellRange { first: x + 2 * y, words: 4 });
        let table = CellTable { cells, ..whole };
        for rows in [0..100, 5..6, 31..33, 64..100, 96..97] {
            // Also of what was cut already.
            let (once, twice) = (table.cut(rows.clone()), table.cut(3.min(rows.start)..100));
            assert_eq!(once, twice.cut(rows.start - 3.min(rows.start)..rows.end - 3.min(rows.start)));
            assert_eq!(once.cells.height(), (rows.end - 1) / 32 - rows.start / 32 + 1, "{rows:?}");
            for (y, row) in (0..).zip(rows) {
                assert_eq!([0, 39].map(|x| once.at(x, y)), [0, 39].map(|x| table.at(x, row)));
                assert_eq!(once.row_words(y), table.row_words(row));
            }
        }
    }
}
