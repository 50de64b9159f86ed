//! The paths along which costs are aggregated.

use crate::names::names;

/// The step of a path to the next pixel: columns and rows, each -1, 0 or 1, not both 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    /// Columns per pixel.
    pub dx: i32,
    /// Rows per pixel.
    pub dy: i32,
}

impl Direction {
    /// All directions: those of rows and columns first, then the diagonals. [`Paths`] uses the first three, the first
    /// four or all eight.
    pub const ALL: [Self; 8] = {
        const fn d(dx: i32, dy: i32) -> Direction {
            Direction { dx, dy }
        }
        [d(-1, 0), d(1, 0), d(0, 1), d(0, -1), d(1, 1), d(-1, -1), d(1, -1), d(-1, 1)]
    };
}

/// The number of paths that reach a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paths {
    /// Along the row from both ends and along the column from above: no row has to wait for the rows below it.
    Three,
    /// Along the row and the column, from both ends of each.
    Four,
    /// Along the row, the column and both diagonals, from both ends of each.
    Eight,
}

names!(Paths, "the number of paths", { Three => "3", Four => "4", Eight => "8" });

impl Paths {
    /// The directions of the paths.
    pub fn directions(self) -> &'static [Direction] {
        match self {
            Self::Three => &Direction::ALL[..3],
            Self::Four => &Direction::ALL[..4],
            Self::Eight => &Direction::ALL,
        }
    }
}
