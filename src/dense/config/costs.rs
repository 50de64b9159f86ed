//! Matching by census, luma and gradient costs.

use super::{Cost, Direction, Paths, Penalties};
use crate::error::{Result, check, check_range};

/// The largest side of a window over which costs are averaged, in pixels.
const MAX_WINDOW: u32 = 31;

/// Costs of pixels, averaged over a window and summed up along paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CostAggregation {
    /// How pixels are compared.
    pub cost: Cost,
    /// The side of a square in pixels, odd, 1 to 31, over which the costs of each disparity are averaged before anything
    /// else; 1 leaves them as they are.
    pub window: u32,
    /// The paths along which costs are summed up. `None` is block matching: the least cost of a pixel's window decides.
    pub semi_global: Option<SemiGlobal>,
    /// How the left-right consistency check gets the disparities of the other view.
    pub cross_check: CrossCheck,
}

/// Semi-global matching (Hirschmueller, PAMI 2008).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemiGlobal {
    /// The penalties for changes of disparity along a path.
    pub penalties: Penalties,
    /// The directions from which a pixel is reached.
    pub paths: Paths,
}

/// How the left-right consistency check gets the disparities of the other view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossCheck {
    /// From a search of its own, for as much work again.
    Searched,
    /// From the winners of the reference view: of all pixels with the same partner, the cheapest claims it.
    Claimed,
}

impl CostAggregation {
    /// Refuses parameters that do not fit the volumes of 8 bits.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        check(
            !self.window.is_multiple_of(2) && self.window <= MAX_WINDOW,
            "the window of costs",
            self.window,
            format!("it must be odd and 1 to {MAX_WINDOW}"),
        )?;
        let Cost { census, difference, gradient } = self.cost;
        for (name, value) in [
            ("the weight of the census", census),
            ("the weight of the difference", difference.weight),
            ("the weight of the gradient", gradient.weight),
            ("the limit of the difference", difference.limit),
            ("the limit of the gradient", gradient.limit),
        ] {
            check_range(name, value, 0..=1 << 12)?;
        }
        self.semi_global.map_or(Ok(()), |semi_global| semi_global.penalties.validate())
    }

    /// Half the window without its centre.
    pub(in crate::dense) fn radius(&self) -> u32 {
        self.window / 2
    }

    /// The penalties with which the kernels follow paths; without paths a last one is followed at no penalty, which leaves
    /// all costs as they are.
    pub(in crate::dense) fn followed_with(&self) -> Penalties {
        self.semi_global.map_or(Penalties::NONE, |semi_global| semi_global.penalties)
    }

    /// The direction of the path that is followed last, while disparities are selected, and those of the paths that are
    /// stored until then. The last one runs along the rows: nothing of it has to be kept from band to band, and it sees
    /// memory in order.
    pub(in crate::dense) fn last_and_stored(&self) -> (Direction, &'static [Direction]) {
        let directions = self.semi_global.map_or(&[][..], |semi_global| semi_global.paths.directions());
        directions.split_first().map_or((Direction::ALL[0], &[]), |(&last, stored)| (last, stored))
    }
}
