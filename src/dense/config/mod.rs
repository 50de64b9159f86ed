//! What the dense half is asked to do.

mod brightness;
mod cost;
mod interpolation;
mod paths;
mod penalties;
mod refinement;
mod semi_global;
mod view;

pub use brightness::Brightness;
pub use cost::{Cost, Difference, MAX_COST, WEIGHT_BITS};
pub use interpolation::Interpolation;
pub use paths::{Direction, Paths};
pub use penalties::Penalties;
pub use refinement::{Median, Refinement};
pub use semi_global::{CrossCheck, SemiGlobal};
pub use view::View;

use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
};

/// The bits of a key that hold the disparity's index, where paths put the costs together: a cost, a sum of at most 16
/// bits, is above.
pub(crate) const SUM_INDEX_BITS: u32 = 16;

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
    /// Block matching: the sum of absolute differences over a square window.
    Window {
        /// Its side in pixels, odd, 3 to 31.
        side: u32,
        /// Which disparities a pixel is compared at.
        search: Search,
    },
    /// Semi-global matching, or block matching by its costs.
    Paths(SemiGlobal),
}

/// Dense matching and its checks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DenseConfig {
    /// How costs are put together.
    pub aggregation: Aggregation,
    /// What makes the right view as bright as the left one, before lumas are compared.
    pub brightness: Brightness,
    /// The disparities to search.
    pub range: DisparityRange,
    /// The view whose pixels get a disparity.
    pub reference: View,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// By how many per cent the cost of the best rival, two or more disparities away, must exceed
    /// the winner's; 0 accepts every winner, at most 100.
    pub uniqueness: u32,
    /// The largest difference, in 1/256 px, between a pixel's disparity and that of its partner in
    /// the other view; `None` accepts every winner. [`Search::CoarseToFine`] asks the other view at half the size: the
    /// partner there or one to its left or right, and a pixel more is allowed, since disparities there are even.
    pub consistency: Option<u32>,
    /// What becomes of the map after that; `None`: it stays as it is.
    pub refinement: Option<Refinement>,
}

impl DenseConfig {
    /// Plain block matching over `range`: a 7x7 window, the left view, no checks.
    pub fn new(range: DisparityRange) -> Self {
        Self {
            aggregation: Aggregation::Window { side: 7, search: Search::Whole },
            brightness: Brightness::SAME,
            range,
            reference: View::Left,
            interpolation: Interpolation::Equiangular,
            uniqueness: 0,
            consistency: None,
            refinement: None,
        }
    }

    /// The same with windows of this side, and the whole range searched.
    #[must_use]
    pub fn with_window(self, side: u32) -> Self {
        Self { aggregation: Aggregation::Window { side, search: Search::Whole }, ..self }
    }

    /// The side of the window over which costs are summed up: one pixel, where paths do it.
    pub fn window(&self) -> u32 {
        match self.aggregation {
            Aggregation::Window { side, .. } => side,
            Aggregation::Paths(_) => 1,
        }
    }

    /// Whether maps of half the size say what is searched, and confirm it.
    pub(crate) fn is_coarse_to_fine(&self) -> bool {
        matches!(self.aggregation, Aggregation::Window { search: Search::CoarseToFine, .. })
    }

    /// Half the window without its centre.
    pub fn radius(&self) -> u32 {
        self.window() / 2
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
        let limit = (1 << self.index_bits()) - 1;
        if range.count > limit {
            return refuse(format!("at most {limit} disparities fit beside the cost of a window of {}", self.window()));
        }
        Ok(range)
    }

    /// The bits of a 32-bit key that the largest cost of the window leaves for the disparity's index.
    pub(crate) fn index_bits(&self) -> u32 {
        match self.aggregation {
            Aggregation::Window { side, .. } => (255 * side * side).leading_zeros(),
            Aggregation::Paths(_) => SUM_INDEX_BITS,
        }
    }

    /// Refuses what no kernel could work with.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        DisparityRange::new(self.range.min, self.range.count)?;
        let check = |ok: bool, name, value: u32, expected: &str| {
            if ok {
                Ok(())
            } else {
                Err(Error::Parameter { name, value: value.to_string(), expected: expected.into() })
            }
        };
        match &self.aggregation {
            Aggregation::Window { side, .. } => {
                let odd = side % 2 == 1 && (3..=31).contains(side);
                check(odd, "window", *side, "it must be odd and 3 to 31")?;
            }
            Aggregation::Paths(semi_global) => semi_global.validate()?,
        }
        self.brightness.validate()?;
        let support = self.refinement.map_or(0, |refinement| refinement.support);
        check(support <= 49, "support", support, "it must be 0 to 49 pixels")?;
        check(self.uniqueness <= 100, "uniqueness", self.uniqueness, "it must be 0 to 100 per cent")?;
        check(
            self.consistency.is_none_or(|d| d <= 1 << 16),
            "consistency",
            self.consistency.unwrap_or(0),
            "it must be at most 65536 (256 px)",
        )
    }
}
