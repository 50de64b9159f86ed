//! Parameters of interest points, and the interest points themselves.

use crate::error::{Result, check, check_range};

/// Number of values of a descriptor.
pub const DESCRIPTOR_LENGTH: usize = 64;

/// Parameters of detection and description.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureConfig {
    /// Octaves, 1 to 5; 5 by default. Each has four filter sizes, in pixels: 9 15 21 27, 15 27 39 51, 27 51 75 99, 51
    /// 99 147 195, 99 195 291 387.
    pub octaves: u32,
    /// Sampling step of the first octave, 1 or 2 pixels; 1 by default; it doubles with each octave.
    pub step: u32,
    /// Least determinant of the Hessian, above 0 and at most 1, on OpenSURF's scale (grey values 0 to 1); 0.0001 by
    /// default. OpenSURF's own default is 0.0004; the default here finds nearly twice the matches, and a larger share
    /// of them is right.
    pub threshold: f32,
    /// Whether orientations stay 0, the default: better for rectified pairs, where nothing is rotated.
    pub upright: bool,
    /// Most interest points, and the capacity of a [`super::Detector`]'s list, 1 to 1,048,576; 65,536 by default. Of more the
    /// strongest are kept, spread over the picture: the cells of a grid take turns, each with its strongest point that is
    /// left.
    pub max_features: u32,
}

impl Default for FeatureConfig {
    fn default() -> Self {
        Self { octaves: 5, step: 1, threshold: 0.0001, upright: true, max_features: 65_536 }
    }
}

impl FeatureConfig {
    /// Checks that all values lie in their ranges.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        check_range("octaves", self.octaves, 1..=5)?;
        check_range("step", self.step, 1..=2)?;
        check(
            self.threshold > 0.0 && self.threshold <= 1.0,
            "threshold",
            self.threshold,
            "it must be above 0 and at most 1",
        )?;
        check_range("max_features", self.max_features, 1..=1 << 20)
    }
}

/// The interest points of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detected {
    /// The points, sorted by octave, layer, row and column.
    pub features: Vec<Feature>,
    /// Number of points of the picture; more than there are `features` if only the strongest were kept.
    pub found: usize,
}

/// An interest point: where a picture's intensity changes in both directions, at one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Column of its centre in pixels; pixel centres are whole numbers.
    pub x: f32,
    /// Row of its centre in pixels.
    pub y: f32,
    /// Scale, in pixels: the standard deviation of the Gaussian that the filter approximates (1.2 for the 9x9 filter).
    pub scale: f32,
    /// Determinant of the Hessian at the sample, on OpenSURF's scale.
    pub response: f32,
    /// Whether the trace of the Hessian is positive: a dark blob on light ground.
    pub dark: bool,
    /// Direction of the dominant gradient in radians, 0 to 2 pi, x to y; 0 in upright mode.
    pub orientation: f32,
    /// 64 values, of unit length as a vector, or all 0 where the surroundings are flat.
    pub descriptor: [f32; DESCRIPTOR_LENGTH],
}
