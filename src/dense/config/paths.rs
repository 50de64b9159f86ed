//! The paths along which costs are summed up.

/// From where to where a path goes: to the next column and row, each -1, 0 or 1, not both 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    /// Columns a pixel.
    pub dx: i32,
    /// Rows a pixel.
    pub dy: i32,
}

impl Direction {
    /// Along the rows and the columns first, then aslant: those of the first three, the first four or of all eight are used.
    pub const ALL: [Self; 8] = {
        const fn d(dx: i32, dy: i32) -> Direction {
            Direction { dx, dy }
        }
        [d(-1, 0), d(1, 0), d(0, 1), d(0, -1), d(1, 1), d(-1, -1), d(1, -1), d(-1, 1)]
    };
}

/// From how many sides a pixel is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paths {
    /// From none: the least cost of a pixel itself decides. With a window this is block matching.
    None,
    /// Along its row from both ends and along its column from above: no row has to wait for those below it.
    Three,
    /// Along its row and its column.
    Four,
    /// From those and along both diagonals.
    Eight,
}

impl Paths {
    /// Their directions.
    pub fn directions(self) -> &'static [Direction] {
        match self {
            Self::None => &[],
            Self::Three => &Direction::ALL[..3],
            Self::Four => &Direction::ALL[..4],
            Self::Eight => &Direction::ALL,
        }
    }

    /// The one that is followed last, while disparities are selected, and those whose costs are stored until then. The
    /// last is one along the rows: of it nothing has to be kept from band to band, and it sees memory in order. Where there
    /// are none, it is to be followed with [`Penalties::NONE`].
    pub(in crate::dense) fn last_and_stored(self) -> (Direction, &'static [Direction]) {
        self.directions().split_first().map_or((Direction::ALL[0], &[]), |(&last, stored)| (last, stored))
    }
}
