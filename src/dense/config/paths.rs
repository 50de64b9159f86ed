//! The paths along which costs are summed up.

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
    /// Along the rows and the columns first, then along the diagonals: the first three, the first four or all eight are
    /// used.
    pub const ALL: [Self; 8] = {
        const fn d(dx: i32, dy: i32) -> Direction {
            Direction { dx, dy }
        }
        [d(-1, 0), d(1, 0), d(0, 1), d(0, -1), d(1, 1), d(-1, -1), d(1, -1), d(-1, 1)]
    };
}

/// The number of directions from which a pixel is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paths {
    /// Along the pixel's row from both ends and along its column from above: no row has to wait for those below it.
    Three,
    /// Along the row and the column, from both ends of each.
    Four,
    /// Along the row, the column and both diagonals, from both ends of each.
    Eight,
}

names!(Paths, "the number of paths", { Three => "3", Four => "4", Eight => "8" });

impl Paths {
    /// Their directions.
    pub fn directions(self) -> &'static [Direction] {
        match self {
            Self::Three => &Direction::ALL[..3],
            Self::Four => &Direction::ALL[..4],
            Self::Eight => &Direction::ALL,
        }
    }
}
