//! Which view a map belongs to.

/// One of the two views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The left view: its pixel x corresponds to x - d of the right.
    Left,
    /// The right view: its pixel x corresponds to x + d of the left.
    Right,
}

impl View {
    /// Left, then right.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The sign of the way from a pixel of this view to its partner in the other.
    pub(crate) fn direction(self) -> i32 {
        match self {
            Self::Left => -1,
            Self::Right => 1,
        }
    }
}
