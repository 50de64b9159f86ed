//! Everything that can be chosen for a pair, and presets of it.

use crate::{
    dense::{Interpolation, View},
    disparity::DisparityRange,
    features::FeatureConfig,
    seeding::SeedingConfig,
};

/// All parameters of the pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// How interest points are found and described.
    pub features: FeatureConfig,
    /// How they are matched, and what is concluded from the matches.
    pub seeding: SeedingConfig,
    /// The disparities to search; `None`: found from the seeds.
    pub range: Option<DisparityRange>,
    /// The view whose pixels get a disparity.
    pub reference: View,
    /// Side of the matching window in pixels, odd, 3 to 31.
    pub window: u32,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// See [`crate::dense::DenseConfig::uniqueness`].
    pub uniqueness: u32,
    /// See [`crate::dense::DenseConfig::consistency`].
    pub consistency: Option<u32>,
    /// Go on with a pair that is visibly not rectified.
    pub force: bool,
}

/// A set of parameters that go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// What measures best on real pairs: an 11x11 window, checked for uniqueness and from the other
    /// view.
    #[default]
    Standard,
    /// The paper to the letter: the right view is the reference and is searched for in the left to
    /// the right only, in 7x7 windows, with a parabola between the nearest matching window and its
    /// neighbours and no check; orientations are computed, and the ten strongest matches are kept.
    Paper,
}

impl Preset {
    /// The preset's parameters.
    pub fn config(self) -> Config {
        let standard = Config {
            features: FeatureConfig::default(),
            seeding: SeedingConfig::default(),
            range: None,
            reference: View::Left,
            window: 11,
            interpolation: Interpolation::Equiangular,
            uniqueness: 10,
            consistency: Some(256),
            force: false,
        };
        match self {
            Self::Standard => standard,
            Self::Paper => Config {
                features: FeatureConfig { upright: false, ..standard.features },
                reference: View::Right,
                window: 7,
                interpolation: Interpolation::Parabola,
                uniqueness: 0,
                consistency: None,
                ..standard
            },
        }
    }
}
