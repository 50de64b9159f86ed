//! Parameters of dense matching.

mod brightness;
mod compared;
mod cost;
mod costs;
mod interpolation;
mod paths;
mod penalties;
mod refinement;
mod view;

pub use brightness::Brightness;
pub use compared::Compared;
pub use cost::{Cost, Difference, MAX_COST, WEIGHT_BITS};
pub use costs::{CostAggregation, CrossCheck, SemiGlobal};
pub use interpolation::Interpolation;
pub use paths::{Direction, Paths};
pub use penalties::Penalties;
pub(crate) use refinement::Filters;
pub use refinement::{FILLED, Median, Refinement};
pub use view::View;

use crate::{
    disparity::DisparityRange,
    error::{Error, Result, check, check_range},
};

/// Low bits of a key of aggregated costs that hold the disparity's index; the aggregated cost, at most 16 bits, is
/// above them.
pub(crate) const SUM_INDEX_BITS: u32 = 16;

/// The side of the census transform, in pixels.
const CENSUS_SIDE: u32 = 5;

/// The disparities of the range at which a pixel is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// The whole range.
    Whole,
    /// Per cell of the picture, the disparities that a map of half the size shows in and around the cell. Objects too thin
    /// or too small for the half-size map can be lost.
    ///
    /// Block matching by SAD: cells of 16x16 pixels, a margin of 2; the whole range if less than 10 % of the pixels there
    /// have a disparity. The other view is searched at half the size only.
    ///
    /// Costs: see [`crate::dense::Pyramid`].
    CoarseToFine,
    /// Costs only: as [`Self::CoarseToFine`], over so many levels of a pyramid, 1 to 16, whatever the size: a part of a large picture is
    /// searched as the picture is.
    Levels(u32),
}

/// Cost aggregation: from the costs of single pixels to those that decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aggregation {
    /// Block matching by SAD: the sum of absolute differences of one byte per pixel over a square window.
    Sad {
        /// Side of the window, odd, 3 to 31 pixels.
        side: u32,
        /// The disparities at which a pixel is compared.
        search: Search,
        /// The bytes that are compared.
        compared: Compared,
    },
    /// Costs of census, luma and gradient, aggregated semi-globally or by blocks.
    Costs(CostAggregation),
}

/// Parameters of dense matching that do not depend on the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DenseParameters {
    /// Cost aggregation; by default SAD of luma over 7x7 pixels, over the whole range.
    pub aggregation: Aggregation,
    /// Sub-pixel interpolation; equiangular by default.
    pub interpolation: Interpolation,
    /// Uniqueness: the percentage by which the cost of the best rival, two or more disparities away, must exceed the
    /// winner's, 0 to 100. 0, the default, accepts every winner.
    pub uniqueness: u32,
    /// Left-right consistency: the largest accepted difference between a pixel's disparity and that of its partner in
    /// the other view, 0 to 65,536 in 1/256 px. `None`, the default, accepts every winner. [`Search::CoarseToFine`]
    /// compares with the half-size map of the other view, at the partner there or the pixel to its left or right, and
    /// accepts 1 px more, since twice a half-size disparity is even.
    pub consistency: Option<u32>,
    /// Agreement: of nine pixels, the pixel itself and the eight pixels 3 columns, rows, or both away, the number whose
    /// disparities must lie within 2 px of the pixel's for the pixel to keep its disparity, 0 to 9. 0, the default, or 1
    /// accepts every disparity.
    pub agreement: u32,
    /// Refinement of the map; `None`, the default, leaves the map as it is.
    pub refinement: Option<Refinement>,
}

impl Default for DenseParameters {
    /// Block matching of luma in windows of 7x7 pixels, without checks.
    fn default() -> Self {
        Self {
            aggregation: Aggregation::Sad { side: 7, search: Search::Whole, compared: Compared::Luma },
            interpolation: Interpolation::Equiangular,
            uniqueness: 0,
            consistency: None,
            agreement: 0,
            refinement: None,
        }
    }
}

/// Parameters of dense matching of a pair.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DenseConfig {
    /// The disparities to search, in whole pixels.
    pub range: DisparityRange,
    /// The reference view, whose pixels get a disparity; left by default.
    pub reference: View,
    /// The change of the right view's brightness before matching; none by default.
    pub brightness: Brightness,
    /// The parameters that do not depend on the pair.
    pub parameters: DenseParameters,
}

impl DenseConfig {
    /// The left view as the reference, no change of brightness, and [`DenseParameters::default`].
    pub fn new(range: DisparityRange) -> Self {
        let parameters = DenseParameters::default();
        Self { range, reference: View::Left, brightness: Brightness::SAME, parameters }
    }

    /// This configuration with changed parameters.
    #[must_use]
    pub fn with(self, change: impl FnOnce(&mut DenseParameters)) -> Self {
        let mut parameters = self.parameters;
        change(&mut parameters);
        Self { parameters, ..self }
    }

    /// This configuration with SAD of luma in windows of this side, 3 to 31 pixels and odd, over the whole range.
    #[must_use]
    pub fn with_window(self, side: u32) -> Self {
        self.with(|parameters| {
            parameters.aggregation = Aggregation::Sad { side, search: Search::Whole, compared: Compared::Luma };
        })
    }

    /// The searched disparities in a picture `width` pixels wide: the part of the range that gives at least one pixel a
    /// partner.
    ///
    /// # Errors
    /// [`Error::Parameter`] if that part is empty, or if it has more disparities than the keys of the kernels can
    /// index.
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

    /// Checks that all values lie in their ranges.
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
    /// The smallest accepted side of a picture, in pixels: the side of the SAD window or of the census transform.
    pub(crate) fn smallest_side(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => side,
            Aggregation::Costs(_) => CENSUS_SIDE,
        }
    }

    /// Side of the SAD window, in pixels; 1 without SAD.
    pub(crate) fn window(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => side,
            Aggregation::Costs(_) => 1,
        }
    }

    /// Radius of the SAD window, (side - 1) / 2, in pixels.
    pub(crate) fn radius(&self) -> u32 {
        self.window() / 2
    }

    /// Whether the agreement check drops any disparity.
    pub(crate) fn checks_agreement(&self) -> bool {
        self.agreement > 1
    }

    /// Whether the whole map is worked on after the matching: checked for agreement, or refined.
    pub(crate) fn goes_on(&self) -> bool {
        self.checks_agreement() || self.refinement.is_some()
    }

    /// Whether half-size maps give the ranges of cells and confirm matches.
    pub(crate) fn is_coarse_to_fine(&self) -> bool {
        matches!(self.aggregation, Aggregation::Sad { search: Search::CoarseToFine, .. })
    }

    /// Whether fewer disparities than the whole range may be searched: coarse to fine, or over a pyramid, which neither averages costs over
    /// a window, nor goes without paths, nor searches the other view too.
    pub(crate) fn may_search_less(&self) -> bool {
        match &self.aggregation {
            Aggregation::Sad { search, .. } => *search == Search::CoarseToFine,
            Aggregation::Costs(costs) => {
                let is_checked_by_claims = self.consistency.is_none() || costs.cross_check == CrossCheck::Claimed;
                let searches_less = costs.search != Search::Whole;
                searches_less && costs.window == 1 && costs.semi_global.is_some() && is_checked_by_claims
            }
        }
    }

    /// Whether holes are filled.
    pub(crate) fn fills(&self) -> bool {
        self.refinement.is_some_and(|refinement| refinement.fill)
    }

    /// Bits of a 32-bit key that the largest cost of the window leaves to the disparity's index.
    pub(crate) fn index_bits(&self) -> u32 {
        match self.aggregation {
            Aggregation::Sad { side, .. } => (255 * side * side).leading_zeros(),
            Aggregation::Costs(_) => SUM_INDEX_BITS,
        }
    }

    /// See [`DenseConfig::validate`].
    pub(crate) fn validate(&self) -> Result<()> {
        match &self.aggregation {
            Aggregation::Sad { side, search, .. } => {
                let expected = "block matching searches the whole range, or coarse to fine";
                check(!matches!(search, Search::Levels(_)), "the search", "over levels", expected)?;
                check(side % 2 == 1 && (3..=31).contains(side), "window", side, "it must be odd and 3 to 31")?;
            }
            Aggregation::Costs(costs) => costs.validate()?,
        }
        self.refinement.map_or(Ok(()), |refinement| refinement.validate())?;
        check(self.uniqueness <= 100, "uniqueness", self.uniqueness, "it must be 0 to 100 per cent")?;
        let consistency = self.consistency.unwrap_or(0);
        check(consistency <= 1 << 16, "consistency", consistency, "it must be at most 65536 (256 px)")?;
        check_range("agreement", self.agreement, 0..=9)
    }
}
