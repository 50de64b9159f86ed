//! The two views of a pair.

use crate::names::names;

/// One of the two views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// The left view: its pixel x corresponds to pixel x - d of the right view.
    #[default]
    Left,
    /// The right view: its pixel x corresponds to pixel x + d of the left view.
    Right,
}

names!(View, "the view", { Left => "left", Right => "right" });

impl View {
    /// The other view.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The sign of the step from a pixel of this view to its partner in the other.
    pub(crate) fn direction(self) -> i32 {
        match self {
            Self::Left => -1,
            Self::Right => 1,
        }
    }
}
