//! Parameters of the pipeline, and presets.

use crate::{
    dense::{
        Aggregation, Brightness, Compared, CostAggregation, DenseConfig, DenseParameters, Interpolation, Paths,
        Refinement, Search, SemiGlobal, View,
    },
    disparity::DisparityRange,
    error::Result,
    features::FeatureConfig,
    kamencay::{KamencayConfig, KamencayParameters},
    matching::MatchConfig,
    names::names,
    seeding::SeedingConfig,
    tiles::Tiling,
};

/// Method of the disparity map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Block matching or semi-global matching: see [`crate::dense`].
    Hsad(DenseParameters),
    /// The method that the paper compares itself with: see [`crate::kamencay`].
    Kamencay(KamencayParameters),
}

/// Parameters of the pipeline. The default is [`Preset::Balanced`].
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Detection and description of interest points.
    pub features: FeatureConfig,
    /// Matching of interest points, and the test of rectification.
    pub seeding: SeedingConfig,
    /// Disparity range to search, in pixels; `None`, the default, derives it from the matches.
    pub range: Option<DisparityRange>,
    /// Lower limit of a range derived from the matches, in pixels: 0 excludes negative disparities. `None`, the default:
    /// no limit.
    pub least: Option<i32>,
    /// Method of the disparity map.
    pub method: Method,
    /// Reference view: the view whose pixels get disparities; the left one by default.
    pub reference: View,
    /// The tiles in which the map is computed, so that memory is that of a tile; `None`, the default: the whole picture at once.
    /// [`Method::Hsad`] only.
    pub tiles: Option<Tiling>,
    /// Whether the right view gets the brightness of the left one, by the relation that the matches show; true by default.
    pub equalise: bool,
    /// Whether the right view is resampled where the matches show that its rows are slightly off; true by default.
    pub align: bool,
    /// Whether a pair that is measurably not rectified is matched all the same; false by default.
    pub force: bool,
}

impl Default for Config {
    fn default() -> Self {
        Preset::default().config()
    }
}

impl Config {
    /// Checks that all values lie in their ranges.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        self.features.validate()?;
        let in_row = MatchConfig { max_dy: Some(self.seeding.max_dy), ..self.seeding.matching.clone() };
        in_row.validate()?;
        let range = self.range.unwrap_or(DisparityRange { min: self.least.unwrap_or(0), count: 1 });
        DisparityRange::new(range.min, range.count)?;
        self.tiles.as_ref().map_or(Ok(()), Tiling::validate)?;
        match &self.method {
            Method::Hsad(parameters) => parameters.validate(),
            Method::Kamencay(parameters) => parameters.validate(),
        }
    }

    /// Smallest accepted side of a picture, in pixels: the side of the matching window, or of the census transform. The
    /// windows of Kamencay's method may lie outside the picture.
    pub(crate) fn smallest_side(&self) -> u32 {
        match &self.method {
            Method::Hsad(parameters) => parameters.smallest_side(),
            Method::Kamencay(_) => 1,
        }
    }

    /// The configuration of dense matching with `parameters` in `range`, with a change of the right view's brightness.
    pub(crate) fn dense(
        &self,
        parameters: &DenseParameters,
        range: DisparityRange,
        brightness: Brightness,
    ) -> DenseConfig {
        DenseConfig { range, reference: self.reference, brightness, parameters: *parameters }
    }

    /// The configuration of Kamencay's method with `parameters` in `range`, with a change of the right view's brightness.
    pub(crate) fn kamencay(
        &self,
        parameters: &KamencayParameters,
        range: DisparityRange,
        brightness: Brightness,
    ) -> KamencayConfig {
        KamencayConfig { range, reference: self.reference, brightness, parameters: *parameters }
    }
}

/// Default threshold of OpenSURF for the determinant of the Hessian.
const OPENSURF_THRESHOLD: f32 = 0.0004;

/// A named set of parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// Block matching of soft ranks in windows of 9x9, coarse to fine, checked for uniqueness and for agreement of
    /// neighbours; with holes.
    Fast,
    /// Semi-global matching along three paths, checked and filled.
    #[default]
    Balanced,
    /// Semi-global matching along four paths, checked, filled and refined further.
    Quality,
    /// The paper to the letter: the right view is the reference, its pixels are searched in the left view to the right only,
    /// in 7x7 windows, with parabola interpolation and no check; interest points have orientations. The paper does not say
    /// where the disparity range comes from: it is derived from all matches.
    Paper,
}

names!(Preset, "the preset", { Fast => "fast", Balanced => "balanced", Quality => "quality", Paper => "paper" });

impl Preset {
    /// Parameters of the pipeline.
    pub fn config(self) -> Config {
        let balanced = Config {
            features: FeatureConfig::default(),
            seeding: SeedingConfig::default(),
            range: None,
            least: None,
            method: Method::Hsad(self.dense_parameters()),
            reference: View::Left,
            tiles: None,
            equalise: true,
            align: true,
            force: false,
        };
        match self {
            Self::Fast | Self::Balanced | Self::Quality => balanced,
            Self::Paper => Config {
                features: FeatureConfig { upright: false, threshold: OPENSURF_THRESHOLD, ..balanced.features },
                least: Some(0),
                reference: View::Right,
                equalise: false,
                align: false,
                ..balanced
            },
        }
    }

    /// The configuration of a [`crate::Matcher`]: dense matching in `range`, without a change of brightness; costs are
    /// searched over the whole range.
    pub fn dense_config(self, range: DisparityRange) -> DenseConfig {
        let mut parameters = self.dense_parameters();
        if let Aggregation::Costs(costs) = &mut parameters.aggregation {
            costs.search = Search::Whole;
        }
        self.config().dense(&parameters, range, Brightness::SAME)
    }

    /// Parameters of dense matching.
    pub fn dense_parameters(self) -> DenseParameters {
        let balanced = DenseParameters {
            aggregation: Aggregation::Costs(CostAggregation::TUNED),
            interpolation: Interpolation::Equiangular,
            uniqueness: 1,
            consistency: Some(256),
            agreement: 0,
            refinement: Some(Refinement {
                support: 12,
                majority: true,
                medians_before: 0,
                fill: true,
                medians_after: 1,
            }),
        };
        match self {
            Self::Balanced => balanced,
            Self::Quality => DenseParameters {
                aggregation: Aggregation::Costs(CostAggregation {
                    semi_global: Some(SemiGlobal { paths: Paths::Four, ..SemiGlobal::TUNED }),
                    ..CostAggregation::TUNED
                }),
                refinement: Some(Refinement {
                    support: 12,
                    majority: true,
                    medians_before: 1,
                    fill: true,
                    medians_after: 2,
                }),
                ..balanced
            },
            Self::Fast => DenseParameters {
                aggregation: Aggregation::Sad { side: 9, search: Search::CoarseToFine, compared: Compared::SoftRank },
                uniqueness: 16,
                consistency: None,
                agreement: 6,
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
            parameters.aggregation = Aggregation::Sad { side: 8, search: Search::Whole, compared: Compared::SoftRank };
        };
        let bad = [
            (with(even), "window is 8"),
            (with(|parameters| parameters.uniqueness = 101), "uniqueness is 101"),
            (with(|parameters| parameters.agreement = 10), "agreement is 10"),
            (
                with(|parameters| parameters.refinement.as_mut().unwrap().medians_after = u32::MAX),
                "medians_after is 4294967295",
            ),
            (
                Config { seeding: SeedingConfig { max_dy: f32::NAN, ..Default::default() }, ..balanced() },
                "max_dy is NaN",
            ),
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
