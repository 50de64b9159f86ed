//! What the dense half is asked to do.

mod brightness;
mod cost;
mod costs;
mod interpolation;
mod paths;
mod penalties;
mod refinement;
mod view;

pub use brightness::Brightness;
pub use cost::{Cost, Difference, MAX_COST, WEIGHT_BITS};
pub use costs::{CostAggregation, CrossCheck, SemiGlobal};
pub use interpolation::Interpolation;
pub use paths::{Direction, Paths};
pub use penalties::Penalties;
pub use refinement::{Median, Refinement};
pub use view::View;

use crate::{
    disparity::DisparityRange,
    error::{Error, Result, check},
};

/// The bits of a key that hold the disparity's index, where paths put the costs together: a cost, a sum of at most 16
/// bits, is above.
pub(crate) const SUM_INDEX_BITS: u32 = 16;

/// The side of the census transform, in pixels.
const CENSUS_SIDE: u32 = 5;

/// Which disparities of a range a pixel is compared at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// All of them.
    Whole,
    /// Those that a map of half the size shows around it, and a few more; all, where that map has holes. A
    /// thing that is too thin or too small to be seen at half the size may be lost. The other view is searched at half the
    /// size only.
    CoarseToFine,
}

/// How the costs of single pixels become those by which disparities are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aggregation {
    /// Block matching: the sum of absolute differences of luma over a square window.
    Sad {
        /// The side of the window in pixels, odd, 3 to 31.
        side: u32,
        /// Which disparities a pixel is compared at.
        search: Search,
    },
    /// Costs from census, luma and gradient, semi-globally or by blocks.
    Costs(CostAggregation),
}

/// Dense matching and its checks, whatever the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DenseParameters {
    /// How costs are put together.
    pub aggregation: Aggregation,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// By how many per cent the cost of the best rival, two or more disparities away, must exceed the winner's, 0 to 100;
    /// 0 accepts every winner.
    pub uniqueness: u32,
    /// The largest difference, in 1/256 px, between a pixel's disparity and that of its partner in the other view, at most
    /// 65,536 (256 px); `None` accepts every winner. [`Search::CoarseToFine`] asks the other view at half the size: the
    /// partner there or one to its left or right, and 1 px more is allowed, since disparities there are even.
    pub consistency: Option<u32>,
    /// The refinement of the map; `None` leaves the map as it is.
    pub refinement: Option<Refinement>,
}

impl Default for DenseParameters {
    /// Plain block matching in windows of 7x7 pixels, without any check.
    fn default() -> Self {
        Self {
            aggregation: Aggregation::Sad { side: 7, search: Search::Whole },
            interpolation: Interpolation::Equiangular,
            uniqueness: 0,
            consistency: None,
            refinement: None,
        }
    }
}

/// Dense matching of a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DenseConfig {
    /// The disparities to search.
    pub range: DisparityRange,
    /// The view whose pixels get a disparity.
    pub reference: View,
    /// The change that makes the right view as bright as the left one, before the views are compared.
    pub brightness: Brightness,
    /// Everything that does not depend on the pair.
    pub parameters: DenseParameters,
}

impl DenseConfig {
    /// The left view as the reference, its brightness taken as it is, and [`DenseParameters::default`].
    pub fn new(range: DisparityRange) -> Self {
        let parameters = DenseParameters::default();
        Self { range, reference: View::Left, brightness: Brightness::SAME, parameters }
    }

    /// The same with other parameters.
    #[must_use]
    pub fn with(self, change: impl FnOnce(&mut DenseParameters)) -> Self {
        let mut parameters = self.parameters;
        change(&mut parameters);
        Self { parameters, ..self }
    }

    /// The same with SAD windows of this side, and the whole range searched.
    #[must_use]
    pub fn with_window(self, side: u32) -> Self {
        self.with(|parameters| parameters.aggregation = Aggregation::Sad { side, search: Search::Whole })
    }

    /// The disparities that are searched in a picture of this width: those of the range that give at
    /// least one pixel a partner.
    ///
    /// # Errors
    /// [`Error::Parameter`] where there are none, or more than the kernel's keys can tell apart.
    pub fn searched(&self, width: u32) -> Result<DisparityRange> {
        let reach = i32::try_from(width.saturating_sub(1)).unwrap_or(i32::MAX);
        let (first, last) = (self.range.min.max(-reach), self.range.last().min(reach));
        let refuse = |expected| {
            let value = format!("{} to {}", self.range.min, self.range.last());
            Err(Error::Parameter { name: "the disparity range", value, expected })
        };
        if first > last {
            return refuse(format!("no pixel of a picture {width} px wide has a partner that far away"));
        }
        let range = DisparityRange::inclusive(first, last)?;
        let limit = (1 << self.parameters.index_bits()) - 1;
        if range.count > limit {
            let window = self.parameters.window();
            return refuse(format!("at most {limit} disparities fit beside the cost of a window of {window}"));
        }
        Ok(range)
    }

    /// Refuses values outside their ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        DisparityRange::new(self.range.min, self.range.count)?;
        self.brightness.validate()?;
        self.parameters.validate()
    }
}

impl DenseParameters {
    /// The smallest side of a picture in pixels: that of the matching window, or of the census transform.
    pub(crate) fn smallest_side(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => side,
            Aggregation::Costs(_) => CENSUS_SIDE,
        }
    }

    /// The side of the window of absolute differences, in pixels; 1 without one.
    pub(crate) fn window(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => side,
            Aggregation::Costs(_) => 1,
        }
    }

    /// Half the window of absolute differences without its centre, in pixels.
    pub(crate) fn radius(&self) -> u32 {
        self.window() / 2
    }

    /// Whether maps of half the size say what is searched, and confirm it.
    pub(crate) fn is_coarse_to_fine(&self) -> bool {
        matches!(self.aggregation, Aggregation::Sad { search: Search::CoarseToFine, .. })
    }

    /// The bits of a 32-bit key that the largest cost of the window leaves for the disparity's index.
    pub(crate) fn index_bits(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => (255 * side * side).leading_zeros(),
            Aggregation::Costs(_) => SUM_INDEX_BITS,
        }
    }

    /// As [`DenseConfig::validate`].
    pub(crate) fn validate(&self) -> Result<()> {
        match &self.aggregation {
            Aggregation::Sad { side, .. } => {
                check(side % 2 == 1 && (3..=31).contains(side), "window", side, "it must be odd and 3 to 31")?;
            }
            Aggregation::Costs(costs) => costs.validate()?,
        }
        let support = self.refinement.map_or(0, |refinement| refinement.support);
        check(support <= 49, "support", support, "it must be 0 to 49 pixels")?;
        check(self.uniqueness <= 100, "uniqueness", self.uniqueness, "it must be 0 to 100 per cent")?;
        let consistency = self.consistency.unwrap_or(0);
        check(consistency <= 1 << 16, "consistency", consistency, "it must be at most 65536 (256 px)")
    }
}
