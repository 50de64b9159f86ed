//! What counts as a match.

use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
};

/// How descriptors of two views are matched, and which matches are kept.
///
/// The default knows nothing about the geometry of the views, as the diagnosis of a pair that may not be rectified
/// needs it: [`MatchConfig::max_dy`] would hide exactly what is to be found.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchConfig {
    /// The largest ratio of the distance of the nearest descriptor to that of its rival; above 0, and 1 keeps every
    /// match that has the smaller distance.
    pub ratio: f32,
    /// Keep a match only if each of the two is the other's nearest.
    pub mutual: bool,
    /// Match bright blobs with bright ones and dark with dark only (the sign of the Laplacian; Bay et al. 2008,
    /// section 4.3).
    pub same_contrast: bool,
    /// The largest difference of rows in pixels. Only for pairs known to be rectified.
    pub max_dy: Option<f32>,
    /// The disparities (left column minus right column) of a match, both ends included.
    pub disparities: Option<DisparityRange>,
    /// Keep this many matches, the most confident ones.
    pub strongest: Option<usize>,
}

impl Default for MatchConfig {
    fn default() -> Self {
        Self { ratio: 0.85, mutual: true, same_contrast: true, max_dy: None, disparities: None, strongest: None }
    }
}

impl MatchConfig {
    /// Refuses what no match could satisfy.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the accepted range.
    pub fn validate(&self) -> Result<()> {
        let check = |ok: bool, name, value: String, expected: &str| {
            if ok { Ok(()) } else { Err(Error::Parameter { name, value, expected: expected.into() }) }
        };
        check(
            self.ratio > 0.0 && self.ratio <= 1.0,
            "ratio",
            self.ratio.to_string(),
            "it must be above 0 and at most 1",
        )?;
        if let Some(max_dy) = self.max_dy {
            check(
                max_dy >= 0.0 && max_dy.is_finite(),
                "max_dy",
                max_dy.to_string(),
                "it must be a number of pixels from 0 up",
            )?;
        }
        if let Some(range) = self.disparities {
            DisparityRange::new(range.min, range.count)?;
        }
        check(self.strongest != Some(0), "strongest", "0".into(), "it must be at least 1")
    }

    /// The same demands with the two views exchanged.
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
