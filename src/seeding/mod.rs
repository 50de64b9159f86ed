//! Seeding: facts about a pair from the matches of its features and a coarse map, namely disparity range, rectification,
//! brightness relation and trust.
//!
//! Seeds do not set disparities of single pixels: dense matching searches the whole range, also where seeds are rare.

mod brightness;
mod coarse;
mod enlarged;
mod evidence;
mod range;
mod rectification;
mod support;
mod verdict;
mod vertical;

pub use brightness::BrightnessRelation;
pub use coarse::CoarseMap;
pub use enlarged::enlarged_feature;
pub use range::{FoundRange, RangeEnd, ThinSupport};
pub use rectification::Rectification;
pub(crate) use support::{GRADIENT, SLACK};
pub use verdict::Verdict;

use crate::{
    cpu,
    dense::Brightness,
    disparity::DisparityRange,
    error::{Error, Result},
    features::{
        Feature,
        strongest::{Ranked, strongest},
    },
    image::{Luma, Size},
    mask::Mask,
    matching::{Match, MatchConfig, Rows, Seed, match_features, refine},
    rectify::RowModel,
};

/// Standard deviation of a normal distribution divided by its median absolute deviation.
const DEVIATIONS: f32 = 1.4826;

/// Most features of a view that are matched in any row, where the time grows with the square of their number: a few
/// thousand tell how rows correspond. All are matched along these rows.
const ANYWHERE: usize = 8192;

/// Parameters of [`Seeding::find`].
#[derive(Clone, Debug, PartialEq)]
pub struct SeedingConfig {
    /// Parameters of descriptor matching. `max_dy` is ignored, since the row differences have to be measured first.
    pub matching: MatchConfig,
    /// Largest row difference of two features in a rectified pair, in pixels, at least 0; 1.5 by default.
    pub max_dy: f32,
}

impl Default for SeedingConfig {
    fn default() -> Self {
        Self { matching: MatchConfig::default(), max_dy: 1.5 }
    }
}

/// Facts about a pair, known before dense matching.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeding {
    /// The disparity range to search, from the seeds and a coarse map of the views, or why it is unknown.
    pub range: std::result::Result<FoundRange, ThinSupport>,
    /// The disparities of surfaces in the pair downscaled to about a hundred columns.
    pub coarse: CoarseMap,
    /// Whether rows correspond.
    pub rectification: Rectification,
    /// Relation of the grey values of the views; `None` if there are too few seeds.
    pub brightness: Option<BrightnessRelation>,
    /// How far the matches speak for a search along rows in the range, 0 to 1: the share of all matches, found in any row,
    /// that lie in corresponding rows and in the range; multiplied by `n / (n + 30)` for `n` of these matches.
    pub agreement: f32,
    /// The seeds that their neighbours support, the most confident first.
    pub seeds: Vec<Seed>,
    /// All matches of the features, found in any row, the most confident first.
    pub matches: Vec<Match>,
}

impl Seeding {
    /// Matches the features of two views and measures rectification, range, brightness relation and agreement. If the
    /// verdict is [`Verdict::Alignable`], all but the rectification is measured with the right view resampled by
    /// [`Rectification::rows`], by the CPU twin.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`] if the views differ in size, [`Error::Parameter`] if the configuration is not valid.
    /// An unknown range is no error here, since the caller may have one: see [`Self::range`].
    pub fn find(
        (left, right): (&Luma, &Luma),
        features: (&[Feature], &[Feature]),
        config: &SeedingConfig,
    ) -> Result<Self> {
        if left.size() != right.size() {
            return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
        }
        let matches = RawMatches::new(features, left.size(), config)?;
        let map = matches.rectification.rows.warp(left.size())?;
        let aligned = map.map(|map| cpu::rectify::warp(right, &map));
        matches.seeding((left, aligned.as_ref().unwrap_or(right)), None, features, config)
    }

    /// What holds for another frame of the same cameras, with the coarse map of its `views`, which are downscaled by `factor` and whose
    /// right one has a change of `brightness`; `seen` masks the left one.
    pub(crate) fn followed(
        &self,
        views: (&Luma, &Luma),
        seen: Option<&Mask>,
        factor: u32,
        brightness: Brightness,
    ) -> Result<Self> {
        let coarse = range::coarse_map(views, seen, &[], brightness)?.enlarged(factor);
        Ok(Self { coarse, ..self.clone() })
    }

    /// Whether `range` holds what the coarse map shows, see [`range::holds`].
    pub(crate) fn holds(&self, range: DisparityRange, ends_at_zero: bool) -> bool {
        range::holds(&self.coarse, range, ends_at_zero)
    }
}

/// Matches of the features of two views in any row, and what they tell of the rows.
#[derive(Clone, Debug)]
pub struct RawMatches {
    /// The matches, the most confident first.
    pub matches: Vec<Match>,
    /// The matches at the positions of the features.
    seeds: Vec<Seed>,
    /// Whether rows correspond.
    pub rectification: Rectification,
}

impl RawMatches {
    /// Matches the features of two views of `size`, in pixels: of more than 8192 the strongest, spread over the view.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the configuration is not valid.
    pub fn new((left, right): (&[Feature], &[Feature]), size: impl Into<Size>, config: &SeedingConfig) -> Result<Self> {
        let size = size.into();
        let anywhere = MatchConfig { max_dy: None, ..config.matching.clone() };
        let [kept_left, kept_right] = [left, right].map(|features| kept(features, size));
        let of = |features: &[Feature], kept: &[usize]| -> Vec<Feature> {
            kept.iter().map(|&index| features[index].clone()).collect()
        };
        let mut matches = match_features(&of(left, &kept_left), &of(right, &kept_right), &anywhere)?;
        for found in &mut matches {
            (found.left, found.right) = (kept_left[found.left], kept_right[found.right]);
        }
        let seeds: Vec<Seed> = matches.iter().map(|found| Seed::from_match(left, right, found)).collect();
        let rectification = Rectification::new(&seeds, size);
        Ok(Self { matches, seeds, rectification })
    }

    /// Range, brightness relation and agreement, from the matches and `views`, whose right one is resampled by
    /// [`Rectification::rows`]; `seen` masks the left view.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the configuration is not valid.
    pub(crate) fn seeding(
        self,
        views: (&Luma, &Luma),
        seen: Option<&Mask>,
        (left, right): (&[Feature], &[Feature]),
        config: &SeedingConfig,
    ) -> Result<Seeding> {
        let Self { matches, seeds: raw, rectification } = self;
        let rows = rectification.rows;
        let seeds = if rectification.is_alignable() {
            let in_row = MatchConfig { max_dy: Some(config.max_dy), ..config.matching.clone() };
            let lifted: Vec<Feature> = right.iter().map(|feature| on_left_row(feature, &rows)).collect();
            let found = match_features(left, &lifted, &in_row)?;
            let seeds = refine(views, (left, &lifted), &found, Rows::Equal);
            seeds.into_iter().map(|seed| on_right_row(seed, &rows)).collect()
        } else {
            refine(views, (left, right), &matches, Rows::Matched)
        };
        let supported = support::supported(&seeds);
        let brightness = BrightnessRelation::new(views.0, views.1, &supported, &rows);
        let equalised = brightness.as_ref().map_or(Brightness::SAME, BrightnessRelation::equalising);
        let coarse = range::coarse_map(views, seen, &supported, equalised)?;
        let range = range::disparity_range(views.0.width(), &supported, seeds.len(), &coarse);
        let agreement = range.map_or(0.0, |found| agreement(&raw, found.range, &rows, config.max_dy));
        Ok(Seeding { range, coarse, rectification, brightness, agreement, seeds: supported, matches })
    }
}

/// The indices of the features of a view of `size` that are matched in any row.
fn kept(features: &[Feature], size: Size) -> Vec<usize> {
    let ranked = |&Feature { x, y, response, .. }: &Feature| Ranked { x: x as u32, y: y as u32, response };
    strongest(&features.iter().map(ranked).collect::<Vec<_>>(), size, ANYWHERE)
}

/// A feature of the right view on the left row that `rows` gives it.
fn on_left_row(feature: &Feature, rows: &RowModel) -> Feature {
    Feature { y: rows.left_row(feature.x.into(), feature.y.into()) as f32, ..feature.clone() }
}

/// A seed of the resampled right view, with its row difference in the right view as given.
fn on_right_row(seed: Seed, rows: &RowModel) -> Seed {
    Seed { dy: (rows.right_row(seed.right_x().into(), seed.y.into()) - f64::from(seed.y)) as f32, ..seed }
}

/// Share of the matches that a search along `rows` in `range` can find, reduced for small numbers.
fn agreement(raw: &[Seed], range: DisparityRange, rows: &RowModel, max_dy: f32) -> f32 {
    /// Number of matches at which the share is halved.
    const FEW: f32 = 30.0;
    let row_error =
        |seed: &Seed| (rows.left_row(seed.right_x().into(), seed.right_y().into()) - f64::from(seed.y)).abs();
    let found = |seed: &&Seed| row_error(seed) <= max_dy.into() && range.contains(seed.disparity.round() as i32);
    let consistent = raw.iter().filter(found).count() as f32;
    if consistent == 0.0 { 0.0 } else { consistent / raw.len() as f32 * consistent / (consistent + FEW) }
}
