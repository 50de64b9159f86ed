//! The disparities worth searching, found from the seeds.

use std::fmt;

use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
    matching::Seed,
};

/// Seeds that it takes to believe in a range.
const NEEDED: usize = 12;
/// What is added beyond the farthest seed, as a share of the seeds' extent.
const FAR_MARGIN: f32 = 0.1;
/// What is added beyond the nearest seed. Much more than at the far end: what is near is large, smooth and often cut
/// by the border, so it bears few features or none. The nine scenes need up to 0.34 here and 0.08 at the far end.
const NEAR_MARGIN: f32 = 0.4;
/// The least that is added at either end, in pixels.
const LEAST_MARGIN: f32 = 3.0;

/// Too few seeds confirm each other to tell the disparity range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThinSupport {
    /// Points that were found in both views.
    pub seeds: usize,
    /// Those that their neighbours confirm.
    pub supported: usize,
}

impl fmt::Display for ThinSupport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seeds, supported } = self;
        write!(f, "{seeds} points were found in both views and {supported} of them confirmed by their neighbours, ")?;
        write!(f, "but {NEEDED} are needed")
    }
}

impl From<ThinSupport> for Error {
    fn from(thin: ThinSupport) -> Self {
        Self::NoRange { reason: thin.to_string() }
    }
}

/// The range that the `supported` ones of `seeds` points span, with its margins.
pub(super) fn disparity_range(supported: &[Seed], seeds: usize) -> std::result::Result<DisparityRange, ThinSupport> {
    let thin = ThinSupport { seeds, supported: supported.len() };
    if supported.len() < NEEDED {
        return Err(thin);
    }
    let (far, near) = extent(supported.iter().map(|seed| seed.disparity));
    widened(far, near).map_err(|_| thin)
}

/// The smallest and the largest.
pub(super) fn extent(disparities: impl Iterator<Item = f32>) -> (f32, f32) {
    disparities.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
}

fn widened(far: f32, near: f32) -> Result<DisparityRange> {
    let margin = |share: f32| (share * (near - far)).max(LEAST_MARGIN);
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
        // 10 to 60: 5 px below, 20 px above.
        let spread = seeds((0..=50).map(|i| 10.0 + i as f32));
        assert_eq!(disparity_range(&spread, 60).unwrap(), DisparityRange::inclusive(5, 80).unwrap());
        // A plane at -7.5: 3 px on both sides, to whole pixels.
        let plane = seeds([-7.5; 20]);
        assert_eq!(disparity_range(&plane, 20).unwrap(), DisparityRange::inclusive(-11, -4).unwrap());
    }

    #[test]
    fn thin_support_is_an_error_with_figures() {
        let thin = disparity_range(&seeds([5.0; 11]), 40).unwrap_err();
        assert_eq!(thin, ThinSupport { seeds: 40, supported: 11 });
        let message = Error::from(thin).to_string();
        assert!(message.contains("40 points") && message.contains("11 of them"), "{message}");
    }
}
