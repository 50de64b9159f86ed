//! Matching by census, luma and gradient costs.

use super::{Cost, Difference, Direction, Paths, Penalties, Search};
use crate::error::{Result, check, check_range};

/// The largest side of a cost-averaging window, in pixels.
const MAX_WINDOW: u32 = 31;

/// Most levels of a search: of pictures of [`crate::luma::MAX_SIDE`] the coarsest has 16 pixels.
const MAX_LEVELS: u32 = 16;

/// Matching costs of pixels, averaged over a window and aggregated along paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CostAggregation {
    /// The matching cost of two pixels.
    pub cost: Cost,
    /// Side of the square window over which the costs of each disparity are averaged before aggregation, in pixels:
    /// odd, 1 to 31; 1 averages nothing.
    pub window: u32,
    /// The paths along which costs are aggregated. `None` is block matching: the smallest averaged cost wins.
    pub semi_global: Option<SemiGlobal>,
    /// The source of the other view's disparities in the left-right consistency check.
    pub cross_check: CrossCheck,
    /// The disparities at which a pixel is compared. [`Search::CoarseToFine`] has effect on large pictures only: see
    /// [`crate::dense::Pyramid`].
    pub search: Search,
}

/// Semi-global matching (Hirschmueller, PAMI 2008).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemiGlobal {
    /// The penalties for changes of disparity along a path.
    pub penalties: Penalties,
    /// The directions from which a pixel is reached.
    pub paths: Paths,
}

/// The source of the other view's disparities in the left-right consistency check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrossCheck {
    /// A second search, with the other view as the reference; doubles the work.
    Searched,
    /// The winners of the reference view: among all pixels with the same partner, the one of least cost claims it.
    Claimed,
}

impl SemiGlobal {
    /// Three paths, with penalties tuned on real pairs: see docs/benchmarks.md.
    pub(crate) const TUNED: Self =
        Self { penalties: Penalties { p1: 16, p2: 80, least_p2: 16, p2_scale: 16 }, paths: Paths::Three };
}

impl CostAggregation {
    /// Costs of the semi-global presets, tuned on real pairs: see docs/benchmarks.md.
    pub(crate) const TUNED: Self = Self {
        cost: Cost {
            census: 20,
            difference: Difference { weight: 4, limit: 24 },
            gradient: Difference { weight: 12, limit: 16 },
            weak_spread: Some(110),
        },
        window: 1,
        semi_global: Some(SemiGlobal::TUNED),
        cross_check: CrossCheck::Claimed,
        search: Search::CoarseToFine,
    };

    /// Checks that costs and penalties fit in cost volumes of 8 bits.
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
        if let Search::Levels(count) = self.search {
            check_range("the levels of the search", count, 1..=MAX_LEVELS)?;
        }
        let Cost { census, difference, gradient, weak_spread } = self.cost;
        for (name, value) in [
            ("the weight of the census", census),
            ("the weight of the difference", difference.weight),
            ("the weight of the gradient", gradient.weight),
            ("the limit of the difference", difference.limit),
            ("the limit of the gradient", gradient.limit),
        ] {
            check_range(name, value, 0..=1 << 12)?;
        }
        if let Some(spread) = weak_spread {
            check_range("the spread of weak texture", spread, 0..=9 * 255)?;
        }
        self.semi_global.map_or(Ok(()), |semi_global| semi_global.penalties.validate())
    }

    /// Radius of the averaging window, (side - 1) / 2, in pixels.
    pub(crate) fn radius(&self) -> u32 {
        self.window / 2
    }

    /// Penalties of the path kernels. Without semi-global aggregation the selection kernel follows one path without
    /// penalties, which leaves all costs unchanged.
    pub(crate) fn followed_with(&self) -> Penalties {
        self.semi_global.map_or(Penalties::NONE, |semi_global| semi_global.penalties)
    }

    /// The directions of all paths; none without semi-global aggregation.
    pub(crate) fn directions(&self) -> &'static [Direction] {
        self.semi_global.map_or(&[], |semi_global| semi_global.paths.directions())
    }

    /// The direction of the last path, which the selection kernel follows, and those of the stored paths. The last path
    /// runs along the rows: it carries nothing from band to band, and its memory accesses are sequential.
    pub(in crate::dense) fn last_and_stored(&self) -> (Direction, &'static [Direction]) {
        self.directions().split_first().map_or((Direction::ALL[0], &[]), |(&last, stored)| (last, stored))
    }
}
