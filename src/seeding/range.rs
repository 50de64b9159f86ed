//! The disparity range to search, from the seeds.

use std::fmt;

use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
    matching::Seed,
};

/// Smallest number of seeds for a range. With 14 seeds, in a quarter of a scene, the range missed 38 % of the pixels.
const NEEDED: usize = 20;
/// Margin beyond the farthest of many seeds, as a share of the seeds' extent.
const FAR_MARGIN: f32 = 0.15;
/// Margin beyond the nearest of many seeds, as a share of the seeds' extent; larger than at the far end, because
/// near objects are large, smooth and often cut by the border, and so bear few features or none. The nine scenes need
/// up to 0.34 here and 0.08 at the far end.
const NEAR_MARGIN: f32 = 0.4;
/// Number of seeds at which the margins double: fewer seeds miss more of the scene, as halves and quarters cut from the
/// nine scenes show.
const FEW: f32 = 40.0;
/// Smallest margin at either end, in pixels.
const LEAST_MARGIN: f32 = 3.0;

/// Too few seeds support each other to determine the disparity range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThinSupport {
    /// Number of seeds, matched points with a distinct cost minimum.
    pub seeds: usize,
    /// Number of the seeds that their neighbours support.
    pub supported: usize,
}

impl fmt::Display for ThinSupport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seeds, supported } = self;
        write!(f, "{seeds} points were found in both views and {supported} of them confirmed by their neighbours, ")?;
        write!(f, "but {NEEDED} are needed")
    }
}

impl std::error::Error for ThinSupport {}

impl From<ThinSupport> for Error {
    fn from(thin: ThinSupport) -> Self {
        Self::NoRange { reason: thin.to_string() }
    }
}

/// The range that the `supported` seeds span, with margins; `seeds` is the number of all seeds.
pub(super) fn disparity_range(supported: &[Seed], seeds: usize) -> std::result::Result<DisparityRange, ThinSupport> {
    let thin = ThinSupport { seeds, supported: supported.len() };
    if supported.len() < NEEDED {
        return Err(thin);
    }
    let (far, near) = extent(supported.iter().map(|seed| seed.disparity));
    widened(far, near, 1.0 + FEW / supported.len() as f32).map_err(|_| thin)
}

/// Smallest and largest disparity.
pub(super) fn extent(disparities: impl Iterator<Item = f32>) -> (f32, f32) {
    disparities.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
}

fn widened(far: f32, near: f32, factor: f32) -> Result<DisparityRange> {
    let margin = |share: f32| (factor * share * (near - far)).max(LEAST_MARGIN);
    DisparityRange::inclusive((far - margin(FAR_MARGIN)).floor() as i32, (near + margin(NEAR_MARGIN)).ceil() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seeds(disparities: impl IntoIterator<Item = f32>) -> Vec<Seed> {
        let seed = |disparity| Seed { x: 0.0, y: 0.0, disparity, dy: 0.0, confidence: 1.0 };
        disparities.into_iter().map(seed).collect()
    }

    #[test]
    fn margins_by_hand() {
        // 200 seeds from 10 to 50: 1.2 * 0.15 * 40 = 7.2 px below, 1.2 * 0.4 * 40 = 19.2 px above.
        let many = seeds((0..200).map(|i| if i % 2 == 0 { 10.0 } else { 50.0 }));
        assert_eq!(disparity_range(&many, 250).unwrap(), DisparityRange::inclusive(2, 70).unwrap());
        // 20 seeds: three times the margins, 18 px and 48 px.
        assert_eq!(disparity_range(&many[..20], 25).unwrap(), DisparityRange::inclusive(-8, 98).unwrap());
        // A plane at -7.5 px: 3 px on both sides, rounded outwards to whole pixels.
        let plane = seeds([-7.5; 20]);
        assert_eq!(disparity_range(&plane, 20).unwrap(), DisparityRange::inclusive(-11, -4).unwrap());
    }

    #[test]
    fn thin_support_is_an_error_with_figures() {
        let thin = disparity_range(&seeds([5.0; 19]), 40).unwrap_err();
        assert_eq!(thin, ThinSupport { seeds: 40, supported: 19 });
        let message = Error::from(thin).to_string();
        assert!(message.contains("40 points") && message.contains("19 of them"), "{message}");
    }
}
