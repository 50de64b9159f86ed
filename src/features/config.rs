//! What to look for, and what is found.

use crate::error::{Result, check, check_range};

/// Values in a descriptor.
pub const DESCRIPTOR_LENGTH: usize = 64;

/// How interest points are found and described.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureConfig {
    /// Octaves of filter sizes, 1 to 5. Each has four intervals: 9 15 21 27, 15 27 39 51,
    /// 27 51 75 99, 51 99 147 195, 99 195 291 387.
    pub octaves: u32,
    /// Sampling step of the first octave in pixels, 1 or 2; it doubles with each octave.
    pub step: u32,
    /// The least determinant of the Hessian, on OpenSURF's scale (grey values 0 to 1). OpenSURF's own
    /// default is 0.0004; the default here finds nearly twice the matches, of which more are right.
    pub threshold: f32,
    /// Leave the orientation at 0: better for rectified pairs, where nothing is rotated.
    pub upright: bool,
    /// Room for this many interest points; more of them is an error, never a silent cut.
    pub max_features: u32,
}

impl Default for FeatureConfig {
    fn default() -> Self {
        Self { octaves: 5, step: 1, threshold: 0.0001, upright: true, max_features: 65_536 }
    }
}

impl FeatureConfig {
    /// Refuses what no kernel could work with.
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

/// An interest point: where a picture's intensity changes in both directions, at one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Column of its centre in pixels; pixel centres are whole numbers.
    pub x: f32,
    /// Row of its centre in pixels.
    pub y: f32,
    /// Scale: the standard deviation, in pixels, of the Gaussian that the filter stands for
    /// (1.2 for the 9x9 filter).
    pub scale: f32,
    /// Determinant of the Hessian at the sample, on OpenSURF's scale.
    pub response: f32,
    /// Whether the trace of the Hessian is positive: a dark blob on light ground.
    pub dark: bool,
    /// Direction of the dominant gradient in radians, 0 to 2 pi, x to y; 0 in upright mode.
    pub orientation: f32,
    /// 64 values of unit length, or all 0 where the surroundings are flat.
    pub descriptor: [f32; DESCRIPTOR_LENGTH],
}
