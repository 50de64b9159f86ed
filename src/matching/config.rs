//! Parameters of descriptor matching.

use crate::{
    disparity::DisparityRange,
    error::{Result, check},
};

/// Parameters of [`match_features`](super::match_features): how descriptors of two views are matched, and which matches
/// are kept.
///
/// The default assumes no geometry of the views, because the diagnosis of rectification needs matches in any row:
/// [`MatchConfig::max_dy`] would hide exactly the errors it looks for.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchConfig {
    /// Ratio test: largest ratio of the distance of the nearest descriptor to that of its rival, above 0, at most 1;
    /// 1 keeps every nearest descriptor, 0.85 by default.
    pub ratio: f32,
    /// Whether a match needs each of its two features to be the nearest of the other; true by default.
    pub mutual: bool,
    /// Whether bright blobs match only bright ones and dark blobs only dark ones (sign of the Laplacian; Bay et al. 2008,
    /// section 4.3); true by default.
    pub same_contrast: bool,
    /// Largest row difference of a match, in pixels, at least 0; only for pairs known to be rectified. `None`, the default: any row.
    pub max_dy: Option<f32>,
    /// Range of the disparity (left column minus right column) of a match, in pixels, both ends included. `None`, the default:
    /// any.
    pub disparities: Option<DisparityRange>,
    /// Number of matches to keep, the most confident ones, at least 1. `None`, the default: all.
    pub strongest: Option<usize>,
}

impl Default for MatchConfig {
    fn default() -> Self {
        Self { ratio: 0.85, mutual: true, same_contrast: true, max_dy: None, disparities: None, strongest: None }
    }
}

impl MatchConfig {
    /// Checks all parameters.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] with the accepted range, for a value outside it.
    pub fn validate(&self) -> Result<()> {
        check(self.ratio > 0.0 && self.ratio <= 1.0, "ratio", self.ratio, "it must be above 0 and at most 1")?;
        if let Some(max_dy) = self.max_dy {
            let expected = "it must be a number of pixels from 0 up";
            check(max_dy >= 0.0 && max_dy.is_finite(), "max_dy", max_dy, expected)?;
        }
        if let Some(range) = self.disparities {
            DisparityRange::new(range.min, range.count)?;
        }
        check(self.strongest != Some(0), "strongest", 0, "it must be at least 1")
    }

    /// The configuration for exchanged views: the disparity range is negated.
    pub(super) fn swapped(&self) -> Self {
        let disparities = self.disparities.map(|range| DisparityRange { min: -range.last(), count: range.count });
        Self { disparities, ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_is_valid_and_nonsense_is_named() {
        assert!(MatchConfig::default().validate().is_ok());
        let bad = [
            (MatchConfig { ratio: 0.0, ..Default::default() }, "ratio"),
            (MatchConfig { ratio: f32::NAN, ..Default::default() }, "ratio"),
            (MatchConfig { max_dy: Some(-1.0), ..Default::default() }, "max_dy"),
            (MatchConfig { max_dy: Some(f32::INFINITY), ..Default::default() }, "max_dy"),
            (MatchConfig { strongest: Some(0), ..Default::default() }, "strongest"),
            (
                MatchConfig { disparities: Some(DisparityRange { min: 0, count: 0 }), ..Default::default() },
                "disparities",
            ),
        ];
        for (config, name) in bad {
            let message = config.validate().unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
    }

    #[test]
    fn exchanging_the_views_negates_the_disparities() {
        let range = DisparityRange::inclusive(-3, 10).unwrap();
        let swapped = MatchConfig { disparities: Some(range), ..Default::default() }.swapped();
        assert_eq!(swapped.disparities, Some(DisparityRange::inclusive(-10, 3).unwrap()));
    }
}
