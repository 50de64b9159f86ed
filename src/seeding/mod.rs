//! What the matches of two views tell about the pair as a whole: the disparity range, whether rows correspond,
//! how the brightness differs, and how far a result can be trusted.
//!
//! None of this makes a pixel's disparity: where seeds are thin, the whole range is searched.

mod brightness;
mod enlarged;
mod range;
mod rectification;
mod support;

pub use brightness::BrightnessRelation;
pub use enlarged::enlarged_feature;
pub use range::ThinSupport;
pub use rectification::{Rectification, Verdict};
pub(crate) use support::{GRADIENT, SLACK};

use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
    features::Feature,
    image::Luma,
    matching::{MatchConfig, Rows, Seed, match_features, refine},
};

/// Median absolute deviations in a standard deviation of a normal distribution.
const DEVIATIONS: f32 = 1.4826;

/// How seeds are found and used.
#[derive(Clone, Debug, PartialEq)]
pub struct SeedingConfig {
    /// How features are matched. Its `max_dy` is not used: the rows are what has to be found out.
    pub matching: MatchConfig,
    /// The largest difference of rows of two features in a pair that is rectified, in pixels.
    pub max_dy: f32,
}

impl Default for SeedingConfig {
    fn default() -> Self {
        Self { matching: MatchConfig::default(), max_dy: 1.5 }
    }
}

/// What is known about a pair before any dense work.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeding {
    /// The disparities to be searched, or why they are not known.
    pub range: std::result::Result<DisparityRange, ThinSupport>,
    /// Whether rows correspond.
    pub rectification: Rectification,
    /// How the grey values of the views differ, where enough seeds tell.
    pub brightness: Option<BrightnessRelation>,
    /// How far a dense result can be trusted, 0 to 1: the share of all matches, found without any demand on their
    /// rows, that lie in corresponding rows and in the range; lower where they are few (half at 30 of them).
    pub trust: f32,
    /// The seeds that their neighbours confirm, the most confident first.
    pub seeds: Vec<Seed>,
}

impl Seeding {
    /// Matches the features of two views and draws all conclusions.
    ///
    /// # Errors
    /// [`Error::SizesDiffer`] if the views differ in size, [`Error::Parameter`] if the configuration is not valid.
    /// That a range is not found is no error here, as the caller may have one: see [`Self::range`].
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
        let range = range::disparity_range(&seeds, count);
        Ok(Self {
            brightness: BrightnessRelation::new(views.0, views.1, &seeds),
            trust: range.map_or(0.0, |range| trust(&raw, range, config.max_dy)),
            range,
            rectification,
            seeds,
        })
    }
}

/// The share of the matches that a search along rows in `range` could find, less where they are few.
fn trust(raw: &[Seed], range: DisparityRange, max_dy: f32) -> f32 {
    /// Matches that deserve half the trust of many.
    const FEW: f32 = 30.0;
    let found = |seed: &&Seed| seed.dy.abs() <= max_dy && range.contains(seed.disparity.round() as i32);
    let consistent = raw.iter().filter(found).count() as f32;
    if consistent == 0.0 { 0.0 } else { consistent / raw.len() as f32 * consistent / (consistent + FEW) }
}
