//! Semi-global matching.

use super::{Cost, Paths, Penalties};
use crate::error::{Error, Result};

/// The largest side of a window over which costs are averaged.
const MAX_WINDOW: u32 = 31;

/// Semi-global matching (Hirschmueller, PAMI 2008).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemiGlobal {
    /// How pixels are compared.
    pub cost: Cost,
    /// The side of a square in pixels, odd and at most 31, over which each disparity's costs are averaged before anything
    /// else is done with them; 1 leaves them as they are.
    pub window: u32,
    /// What changes of disparity along a path cost.
    pub penalties: Penalties,
    /// From how many sides a pixel is reached.
    pub paths: Paths,
    /// Where the disparities of the other view come from, that a check compares with.
    pub cross_check: CrossCheck,
}

/// Where the disparities of the other view come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossCheck {
    /// From a search of its own, for as much work again.
    Searched,
    /// From the winners of the reference view: see [`super::Claim`].
    Claimed,
}

impl SemiGlobal {
    /// Refuses what does not fit in the volumes.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        if self.window.is_multiple_of(2) || self.window > MAX_WINDOW {
            return Err(Error::Parameter {
                name: "the window of costs",
                value: self.window.to_string(),
                expected: format!("it must be odd and 1 to {MAX_WINDOW}"),
            });
        }
        let Cost { census, difference, gradient } = self.cost;
        for (name, value) in [
            ("the weight of the census", census),
            ("the weight of the difference", difference.weight),
            ("the weight of the gradient", gradient.weight),
            ("the limit of the difference", difference.limit),
            ("the limit of the gradient", gradient.limit),
        ] {
            if value > 1 << 12 {
                return Err(Error::Parameter {
                    name,
                    value: value.to_string(),
                    expected: "it must be 0 to 4096".into(),
                });
            }
        }
        self.penalties.validate()
    }

    /// Half the window without its centre.
    pub(in crate::dense) fn radius(&self) -> u32 {
        self.window / 2
    }

    /// The penalties with which the kernels follow paths.
    pub(in crate::dense) fn followed_with(&self) -> Penalties {
        if self.paths == Paths::None { Penalties::NONE } else { self.penalties }
    }
}
