//! Everything that can be chosen for a pair, and presets of it.

use crate::{
    dense::{
        Aggregation, Brightness, Cost, CrossCheck, DenseConfig, Difference, Interpolation, Paths, Penalties,
        Refinement, Search, SemiGlobal, View,
    },
    disparity::DisparityRange,
    error::{Error, Result},
    features::FeatureConfig,
    kamencay::{KamencayConfig, KamencayParameters},
    seeding::SeedingConfig,
};

/// How disparities for all pixels are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// As [`crate::dense`] does it.
    Hsad,
    /// As [`crate::kamencay`] does it, for comparison: what aggregates, interpolates, checks and refines there is not
    /// asked for then. [`Config::reference`] and [`Config::equalise`] are.
    Kamencay(KamencayParameters),
}

/// All parameters of the pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How interest points are found and described.
    pub features: FeatureConfig,
    /// How they are matched, and what is concluded from the matches.
    pub seeding: SeedingConfig,
    /// The disparities to search; `None`: found from the seeds.
    pub range: Option<DisparityRange>,
    /// A limit to a range that is found: no disparity below this is searched. 0 searches to one
    /// side only.
    pub least: Option<i32>,
    /// How many interest points and matches a figure shows, the strongest ones; `None`: all. All
    /// conclusions are drawn from all of them.
    pub strongest: Option<usize>,
    /// How the dense half works.
    pub method: Method,
    /// The view whose pixels get a disparity.
    pub reference: View,
    /// How matching costs are put together.
    pub aggregation: Aggregation,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// See [`crate::dense::DenseConfig::uniqueness`].
    pub uniqueness: u32,
    /// See [`crate::dense::DenseConfig::consistency`].
    pub consistency: Option<u32>,
    /// See [`crate::dense::DenseConfig::refinement`].
    pub refinement: Option<Refinement>,
    /// Whether the right view is made as bright as the left one, as far as the seeds tell.
    pub equalise: bool,
    /// Go on with a pair that is visibly not rectified.
    pub force: bool,
}

impl Config {
    /// Refuses what no step could work with, before any of them begins.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        self.features.validate()?;
        self.seeding.matching.validate()?;
        if self.strongest == Some(0) {
            return Err(Error::Parameter {
                name: "strongest",
                value: "0".into(),
                expected: "it must be at least 1".into(),
            });
        }
        let range = self.range.unwrap_or(DisparityRange { min: self.least.unwrap_or(0), count: 1 });
        DisparityRange::new(range.min, range.count)?;
        match &self.method {
            Method::Hsad => self.dense(range, Brightness::SAME).validate(),
            Method::Kamencay(parameters) => self.hybrid(parameters, range, Brightness::SAME).validate(),
        }
    }

    /// The side of the matching window, or of the census transform's where paths put the costs together: smaller
    /// pictures are refused. The hybrid method's windows may lie outside.
    pub fn window(&self) -> u32 {
        match (&self.method, self.aggregation) {
            (Method::Kamencay(_), _) => 1,
            (Method::Hsad, Aggregation::Window { side, .. }) => side,
            (Method::Hsad, Aggregation::Paths(_)) => 5,
        }
    }

    /// What the hybrid method is asked to do in `range`, with the right view's brightness changed first.
    pub fn hybrid(
        &self,
        parameters: &KamencayParameters,
        range: DisparityRange,
        brightness: Brightness,
    ) -> KamencayConfig {
        KamencayConfig { range, reference: self.reference, brightness, parameters: *parameters }
    }

    /// What the dense half is asked to do in `range`, with the right view's brightness changed first.
    pub fn dense(&self, range: DisparityRange, brightness: Brightness) -> DenseConfig {
        DenseConfig {
            aggregation: self.aggregation,
            brightness,
            range,
            reference: self.reference,
            interpolation: self.interpolation,
            uniqueness: self.uniqueness,
            consistency: self.consistency,
            refinement: self.refinement,
        }
    }
}

/// The least determinant of the Hessian that OpenSURF accepts by default.
const OPENSURF_THRESHOLD: f32 = 0.0004;

/// A set of parameters that go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Block matching in windows of 9x9, coarse to fine, checked for uniqueness and, at half the size, from the other view;
    /// with holes.
    Fast,
    /// Semi-global matching along three paths, checked and filled.
    #[default]
    Balanced,
    /// Semi-global matching along four paths, checked, filled and refined further.
    Quality,
    /// The paper to the letter: the right view is the reference and is searched for in the left to
    /// the right only, in 7x7 windows, with a parabola between the nearest matching window and its
    /// neighbours and no check; orientations are computed, and the ten strongest points and matches
    /// are shown. The disparity range, of which the paper does not say where it comes from, is found
    /// from all matches: ten cannot confirm one another.
    Paper,
}

/// Measured on real pairs: see the README.
const SEMI_GLOBAL: SemiGlobal = SemiGlobal {
    cost: Cost {
        census: 20,
        difference: Difference { weight: 4, limit: 24 },
        gradient: Difference { weight: 12, limit: 16 },
    },
    window: 1,
    penalties: Penalties { p1: 16, p2: 80, least_p2: 16, p2_scale: 16 },
    paths: Paths::Three,
    cross_check: CrossCheck::Claimed,
};

impl Preset {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Fast, Self::Balanced, Self::Quality, Self::Paper];

    /// The preset's parameters.
    pub fn config(self) -> Config {
        let balanced = Config {
            features: FeatureConfig::default(),
            seeding: SeedingConfig::default(),
            range: None,
            least: None,
            strongest: None,
            method: Method::Hsad,
            reference: View::Left,
            aggregation: Aggregation::Paths(SEMI_GLOBAL),
            interpolation: Interpolation::Equiangular,
            uniqueness: 1,
            consistency: Some(256),
            refinement: Some(Refinement {
                support: 10,
                medians_before: 0,
                fill: true,
                median_of_filled: false,
                medians_after: 1,
            }),
            equalise: true,
            force: false,
        };
        match self {
            Self::Balanced => balanced,
            Self::Quality => Config {
                aggregation: Aggregation::Paths(SemiGlobal { paths: Paths::Four, ..SEMI_GLOBAL }),
                refinement: Some(Refinement {
                    support: 10,
                    medians_before: 1,
                    fill: true,
                    median_of_filled: true,
                    medians_after: 2,
                }),
                ..balanced
            },
            Self::Fast => Config {
                aggregation: Aggregation::Window { side: 9, search: Search::CoarseToFine },
                uniqueness: 10,
                refinement: None,
                ..balanced
            },
            Self::Paper => Config {
                features: FeatureConfig { upright: false, threshold: OPENSURF_THRESHOLD, ..balanced.features },
                least: Some(0),
                strongest: Some(10),
                reference: View::Right,
                aggregation: Aggregation::Window { side: 7, search: Search::Whole },
                interpolation: Interpolation::Parabola,
                uniqueness: 0,
                consistency: None,
                refinement: None,
                equalise: false,
                ..balanced
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_nonsense_is_named() {
        for preset in Preset::ALL {
            preset.config().validate().unwrap();
        }
        let balanced = || Preset::Balanced.config();
        let bad = [
            (
                Config { aggregation: Aggregation::Window { side: 8, search: Search::Whole }, ..balanced() },
                "window is 8",
            ),
            (Config { strongest: Some(0), ..balanced() }, "strongest is 0"),
            (Config { uniqueness: 101, ..balanced() }, "uniqueness is 101"),
            (Config { least: Some(i32::MIN), ..balanced() }, "the disparity range"),
            (
                Config { range: Some(DisparityRange { min: 0, count: 0 }), ..balanced() },
                "the number of disparities is 0",
            ),
            (Config { features: FeatureConfig { octaves: 6, ..Default::default() }, ..balanced() }, "octaves is 6"),
        ];
        for (config, expected) in bad {
            let error = config.validate().unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
