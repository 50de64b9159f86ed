//! All parameters for a pair, and presets of them.

use crate::{
    dense::{
        Aggregation, Brightness, Cost, CostAggregation, CrossCheck, DenseConfig, DenseParameters, Difference,
        Interpolation, Paths, Penalties, Refinement, Search, SemiGlobal, View,
    },
    disparity::DisparityRange,
    error::Result,
    features::FeatureConfig,
    kamencay::{KamencayConfig, KamencayParameters},
    names::names,
    seeding::SeedingConfig,
};

/// How every pixel gets a disparity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Block matching or semi-global matching: see [`crate::dense`].
    Hsad(DenseParameters),
    /// The method that the paper compares itself with: see [`crate::kamencay`].
    Kamencay(KamencayParameters),
}

/// All parameters of the pipeline. The default is that of [`Preset::Balanced`].
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How interest points are found and described.
    pub features: FeatureConfig,
    /// How interest points are matched, and what the matches must show.
    pub seeding: SeedingConfig,
    /// The disparities to search; `None`: found from the matches.
    pub range: Option<DisparityRange>,
    /// A lower limit, in pixels, to a range that is found: no disparity below is searched; 0 searches to one side only.
    /// `None`: no limit.
    pub least: Option<i32>,
    /// How every pixel gets a disparity.
    pub method: Method,
    /// The view whose pixels get a disparity.
    pub reference: View,
    /// Whether the right view is made as bright as the left one, as far as the matches tell.
    pub equalise: bool,
    /// Whether a pair that is visibly not rectified is matched all the same.
    pub force: bool,
}

impl Default for Config {
    fn default() -> Self {
        Preset::default().config()
    }
}

impl Config {
    /// Refuses values outside their ranges, before any step begins.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        self.features.validate()?;
        self.seeding.matching.validate()?;
        let range = self.range.unwrap_or(DisparityRange { min: self.least.unwrap_or(0), count: 1 });
        DisparityRange::new(range.min, range.count)?;
        match &self.method {
            Method::Hsad(parameters) => parameters.validate(),
            Method::Kamencay(parameters) => parameters.validate(),
        }
    }

    /// The smallest side of a picture that the method takes, in pixels: that of the matching window, or of the census
    /// transform. The windows of Kamencay's method may lie outside the picture.
    pub(crate) fn smallest_side(&self) -> u32 {
        match &self.method {
            Method::Hsad(parameters) => parameters.smallest_side(),
            Method::Kamencay(_) => 1,
        }
    }

    /// Dense matching with these `parameters` in `range`, with the right view's brightness changed first.
    pub(crate) fn dense(
        &self,
        parameters: &DenseParameters,
        range: DisparityRange,
        brightness: Brightness,
    ) -> DenseConfig {
        DenseConfig { range, reference: self.reference, brightness, parameters: *parameters }
    }

    /// Kamencay's method with these `parameters` in `range`, with the right view's brightness changed first.
    pub(crate) fn kamencay(
        &self,
        parameters: &KamencayParameters,
        range: DisparityRange,
        brightness: Brightness,
    ) -> KamencayConfig {
        KamencayConfig { range, reference: self.reference, brightness, parameters: *parameters }
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
    /// neighbours and no check; orientations are computed. The disparity range, of which the paper does not say where it
    /// comes from, is found from all matches.
    Paper,
}

names!(Preset, "the preset", { Fast => "fast", Balanced => "balanced", Quality => "quality", Paper => "paper" });

/// Measured on real pairs: see docs/benchmarks.md.
const COSTS: CostAggregation = CostAggregation {
    cost: Cost {
        census: 20,
        difference: Difference { weight: 4, limit: 24 },
        gradient: Difference { weight: 12, limit: 16 },
    },
    window: 1,
    semi_global: Some(SEMI_GLOBAL),
    cross_check: CrossCheck::Claimed,
};

const SEMI_GLOBAL: SemiGlobal =
    SemiGlobal { penalties: Penalties { p1: 16, p2: 80, least_p2: 16, p2_scale: 16 }, paths: Paths::Three };

impl Preset {
    /// All parameters of the preset.
    pub fn config(self) -> Config {
        let balanced = Config {
            features: FeatureConfig::default(),
            seeding: SeedingConfig::default(),
            range: None,
            least: None,
            method: Method::Hsad(self.dense_parameters()),
            reference: View::Left,
            equalise: true,
            force: false,
        };
        match self {
            Self::Fast | Self::Balanced | Self::Quality => balanced,
            Self::Paper => Config {
                features: FeatureConfig { upright: false, threshold: OPENSURF_THRESHOLD, ..balanced.features },
                least: Some(0),
                reference: View::Right,
                equalise: false,
                ..balanced
            },
        }
    }

    /// Dense matching by the preset in a known `range`, without any change of brightness: for a [`crate::Matcher`].
    pub fn dense_config(self, range: DisparityRange) -> DenseConfig {
        self.config().dense(&self.dense_parameters(), range, Brightness::SAME)
    }

    /// The preset's parameters of dense matching.
    pub fn dense_parameters(self) -> DenseParameters {
        let balanced = DenseParameters {
            aggregation: Aggregation::Costs(COSTS),
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
        };
        match self {
            Self::Balanced => balanced,
            Self::Quality => DenseParameters {
                aggregation: Aggregation::Costs(CostAggregation {
                    semi_global: Some(SemiGlobal { paths: Paths::Four, ..SEMI_GLOBAL }),
                    ..COSTS
                }),
                refinement: Some(Refinement {
                    support: 10,
                    medians_before: 1,
                    fill: true,
                    median_of_filled: true,
                    medians_after: 2,
                }),
                ..balanced
            },
            Self::Fast => DenseParameters {
                aggregation: Aggregation::Sad { side: 9, search: Search::CoarseToFine },
                uniqueness: 10,
                refinement: None,
                ..balanced
            },
            Self::Paper => DenseParameters { interpolation: Interpolation::Parabola, ..DenseParameters::default() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_have_names() {
        for preset in Preset::ALL {
            preset.config().validate().unwrap();
            assert_eq!(preset.to_string().parse::<Preset>().unwrap(), preset);
        }
        let error = "best".parse::<Preset>().unwrap_err().to_string();
        assert_eq!(error, "the preset is 'best', but it must be one of fast, balanced, quality, paper");
    }

    #[test]
    fn nonsense_is_named() {
        let balanced = || Preset::Balanced.config();
        let with = |change: fn(&mut DenseParameters)| {
            let mut parameters = Preset::Balanced.dense_parameters();
            change(&mut parameters);
            Config { method: Method::Hsad(parameters), ..balanced() }
        };
        let even = |parameters: &mut DenseParameters| {
            parameters.aggregation = Aggregation::Sad { side: 8, search: Search::Whole };
        };
        let bad = [
            (with(even), "window is 8"),
            (with(|parameters| parameters.uniqueness = 101), "uniqueness is 101"),
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
