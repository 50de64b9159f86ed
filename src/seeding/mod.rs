//! Seeding: facts about a pair from the matches of its features and a coarse map, namely disparity range, rectification,
//! brightness relation and trust.
//!
//! Seeds do not set disparities of single pixels: dense matching searches the whole range, also where seeds are rare.

mod brightness;
mod coarse;
mod enlarged;
mod range;
mod rectification;
mod support;

pub use brightness::BrightnessRelation;
pub use coarse::CoarseMap;
pub use enlarged::enlarged_feature;
pub use range::{FoundRange, RangeEnd, ThinSupport};
pub use rectification::{Rectification, Verdict};
pub(crate) use support::{GRADIENT, SLACK};

use crate::{
    dense::Brightness,
    disparity::DisparityRange,
    error::{Error, Result},
    features::Feature,
    image::Luma,
    matching::{MatchConfig, Rows, Seed, match_features, refine},
};

/// Standard deviation of a normal distribution divided by its median absolute deviation.
const DEVIATIONS: f32 = 1.4826;

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
    /// Trust in a dense result, 0 to 1: the share of all matches, found in any row, that lie in corresponding rows and
    /// in the range; multiplied by `n / (n + 30)` for `n` of these matches.
    pub trust: f32,
    /// The seeds that their neighbours support, the most confident first.
    pub seeds: Vec<Seed>,
}

impl Seeding {
    /// Matches the features of two views and measures rectification, range, brightness relation and trust.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`] if the views differ in size, [`Error::Parameter`] if the configuration is not valid.
    /// An unknown range is no error here, since the caller may have one: see [`Self::range`].
    pub fn find(views: (&Luma, &Luma), features: (&[Feature], &[Feature]), config: &SeedingConfig) -> Result<Self> {
        if views.0.size() != views.1.size() {
            return Err(Error::SizesDiffer { left: views.0.size(), right: views.1.size() });
        }
        let (left, right) = features;
        let size = views.0.size();

        let anywhere = MatchConfig { max_dy: None, ..config.matching.clone() };
        let matches = match_features(left, right, &anywhere)?;
        let raw: Vec<Seed> = matches.iter().map(|found| Seed::from_match(left, right, found)).collect();
        let rectification = Rectification::new(&raw, size);

        let seeds = if rectification.is_rectified() {
            let in_row = MatchConfig { max_dy: Some(config.max_dy), ..anywhere };
            refine(views, features, &match_features(left, right, &in_row)?, Rows::Equal)
        } else {
            refine(views, features, &matches, Rows::Matched)
        };
        let count = seeds.len();
        let seeds = support::supported(&seeds);
        let brightness = BrightnessRelation::new(views.0, views.1, &seeds);
        let equalised = brightness.as_ref().map_or(Brightness::SAME, BrightnessRelation::equalising);
        let coarse = range::coarse_map(views, &seeds, equalised)?;
        let range = range::disparity_range(size.width, &seeds, count, &coarse);
        Ok(Self {
            brightness,
            trust: range.map_or(0.0, |found| trust(&raw, found.range, config.max_dy)),
            range,
            coarse,
            rectification,
            seeds,
        })
    }
}

/// Share of the matches that a search along rows in `range` can find, reduced for small numbers.
fn trust(raw: &[Seed], range: DisparityRange, max_dy: f32) -> f32 {
    /// Number of matches at which the share is halved.
    const FEW: f32 = 30.0;
    let found = |seed: &&Seed| seed.dy.abs() <= max_dy && range.contains(seed.disparity.round() as i32);
    let consistent = raw.iter().filter(found).count() as f32;
    if consistent == 0.0 { 0.0 } else { consistent / raw.len() as f32 * consistent / (consistent + FEW) }
}
