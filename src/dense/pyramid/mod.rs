//! Semi-global matching of large pictures over a pyramid: each level searches, per cell, only the disparities that the
//! level above found there.
//!
//! After tSGM: Rothermel, Wenzel, Fritsch and Haala, 'SURE: photogrammetric surface reconstruction from imagery', LC3D
//! workshop, Berlin 2012. There each pixel has a range of its own; a range per cell keeps thin objects that a coarse
//! level has not seen at every pixel.

mod cells;

pub use cells::{CellRange, CellTable, SIDE};

use super::{
    config::{Aggregation, DenseConfig, Filters, Search},
    kernels::halved,
};
use crate::{disparity::DisparityRange, image::Size};

/// Largest width of the coarsest level, in pixels. A wire of 3 px in a picture of 1280 px is lost at 320 px. The level above
/// the finest takes an eighth of the work over the whole range, the one above that a sixty-fourth.
const COARSEST: u32 = 800;

/// Smallest number of disparities of a pyramid that saves more than it costs.
const LEAST_DISPARITIES: u32 = 128;

/// Least support on levels but the finest, see [`crate::dense::Refinement::support`]: that of a line one pixel wide. Medians
/// delete such lines.
const SUPPORT: u32 = 7;

/// The levels of a search from coarse to fine by costs: [`Search::CoarseToFine`] of
/// [`crate::dense::CostAggregation`].
///
/// Each level has half the size of the level below. The coarsest, at most 800 px wide, searches the whole range. Each other
/// level searches, per cell of 32x32 pixels, from twice the smallest to twice the largest disparity that the level above has
/// in the cell or in the cells around it, and 2 more at either end, in whole sixteens; cells without any take the
/// disparities of the nearest cells. Along a path, a disparity that the pixel before does not have costs as much as a jump.
/// A winner at an end of its cell's range that is no end of the whole range is none. Levels but the finest keep what 7
/// pixels of a 7x7 window support, and none whose partner does not show the scene; they are neither checked from the other view nor filled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pyramid {
    levels: Vec<Level>,
}

/// A level of a pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Width and height, in pixels.
    pub size: Size,
    /// The disparities of the whole range, in pixels of the level.
    pub range: DisparityRange,
}

impl Pyramid {
    /// Smallest width in pixels of a picture whose pyramid saves more than it costs.
    pub const LEAST_WIDTH: u32 = 1600;

    /// The pyramid by which a pair of `size` is matched; `None` where the whole range is searched: if `config` says so,
    /// averages costs over a window, follows no paths or searches the other view too; and if the picture is narrower than
    /// 1600 px or the range has fewer than 128 disparities, where a pyramid saves little.
    pub fn of(config: &DenseConfig, size: Size) -> Option<Self> {
        let Aggregation::Costs(costs) = &config.parameters.aggregation else { return None };
        let is_possible = config.parameters.may_search_less();
        let range = config.searched(size.width).ok().filter(|_| is_possible)?;
        let is_large = size.width >= Self::LEAST_WIDTH && range.count >= LEAST_DISPARITIES;
        match costs.search {
            Search::CoarseToFine if is_large => Some(Self::down_to(COARSEST, size, range)),
            Search::Levels(count) if count > 1 => Some(Self::of_levels(count, size, range)),
            _ => None,
        }
    }

    /// A pyramid whose coarsest level is at most `coarsest` px wide.
    pub fn down_to(coarsest: u32, size: Size, range: DisparityRange) -> Self {
        let all = std::iter::successors(Some(Level { size, range }), |level| {
            (level.size.width > coarsest.max(1)).then(|| level.half())
        });
        Self { levels: all.collect() }
    }

    /// A pyramid of `count` levels.
    fn of_levels(count: u32, size: Size, range: DisparityRange) -> Self {
        let all = std::iter::successors(Some(Level { size, range }), |level| Some(level.half()));
        Self { levels: all.take(count as usize).collect() }
    }

    /// The levels, the finest first.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }
}

impl Level {
    fn half(&self) -> Self {
        let Size { width, height } = self.size;
        Self { size: Size::new(width.div_ceil(2), height.div_ceil(2)), range: halved(self.range) }
    }

    /// The configuration of the finest level, in the range of the whole picture.
    pub(crate) fn finest(&self, config: &DenseConfig) -> DenseConfig {
        DenseConfig { range: self.range, ..config.clone() }
    }

    /// The configuration of any other level, whose map is refined by [`filters`] alone.
    pub(crate) fn coarse(&self, config: &DenseConfig) -> DenseConfig {
        self.finest(config).with(|parameters| {
            parameters.consistency = None;
            parameters.agreement = 0;
            parameters.refinement = None;
        })
    }
}

/// The filters of the maps of all levels but the finest.
pub(crate) fn filters() -> Filters {
    Filters { support: SUPPORT, majority: false, before: Vec::new(), fill: false, after: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{config::Preset, dense::config::CrossCheck};

    #[test]
    fn levels_by_hand() {
        let range = DisparityRange::inclusive(-3, 200).unwrap();
        let pyramid = Pyramid::down_to(400, Size::new(1601, 3), range);
        let levels: Vec<_> =
            pyramid.levels().iter().map(|l| (l.size.width, l.size.height, l.range.min, l.range.last())).collect();
        assert_eq!(levels, [(1601, 3, -3, 200), (801, 2, -2, 100), (401, 1, -1, 50), (201, 1, -1, 25)]);
        assert_eq!(Pyramid::down_to(0, Size::new(1, 1), range).levels().len(), 1);
    }

    #[test]
    fn small_pictures_and_narrow_ranges_are_searched_whole() {
        let config = |count| {
            Preset::Balanced.config().dense(
                &Preset::Balanced.dense_parameters(),
                DisparityRange::new(0, count).unwrap(),
                crate::dense::Brightness::SAME,
            )
        };
        let levels = |config: &DenseConfig, width| Pyramid::of(config, Size::new(width, 700)).map(|p| p.levels().len());
        assert_eq!(levels(&config(128), 1600), Some(2));
        assert_eq!(levels(&config(128), 1599), None);
        assert_eq!(levels(&config(127), 1600), None);
        let changed = |change: fn(&mut crate::dense::CostAggregation)| {
            let config = config(200).with(|parameters| {
                let Aggregation::Costs(costs) = &mut parameters.aggregation else { unreachable!() };
                change(costs);
            });
            levels(&config, 2000)
        };
        assert_eq!(changed(|_| ()), Some(3));
        assert_eq!(changed(|costs| costs.search = Search::Whole), None);
        assert_eq!(
            levels(
                &config(40).with(|parameters| {
                    let Aggregation::Costs(costs) = &mut parameters.aggregation else { unreachable!() };
                    costs.search = Search::Levels(4);
                }),
                100
            ),
            Some(4)
        );
        assert_eq!(changed(|costs| costs.search = Search::Levels(1)), None);
        assert_eq!(changed(|costs| costs.window = 3), None);
        assert_eq!(changed(|costs| costs.semi_global = None), None);
        assert_eq!(changed(|costs| costs.cross_check = CrossCheck::Searched), None);
    }
}
