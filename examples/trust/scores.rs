//! Scores of a map against the truth of its scene.

use hsad::{Dense, DisparityRange, disparity, eval::scene::Scene};

use crate::AnyError;

/// Places of 1 px and 2 px in `hsad::eval::scene::THRESHOLDS`.
const ONE_PIXEL: usize = 1;
const TWO_PIXELS: usize = 2;

/// Shares of pixels wrong by over 1 px or without disparity, 0 to 1.
#[derive(Clone, Copy)]
pub struct BadOne {
    /// Of the non-occluded pixels with known truth; NaN without a mask.
    pub non_occluded: f64,
    /// Of all pixels with known truth.
    pub all: f64,
}

/// Shares of pixels wrong by over 1 px or without disparity.
pub fn bad_one(scene: &Scene, dense: &Dense) -> Result<BadOne, AnyError> {
    let scores = scene.score(&disparity::in_pixels(&dense.disparity))?;
    Ok(BadOne {
        non_occluded: scores.non_occluded.map_or(f64::NAN, |score| score.bad[ONE_PIXEL].of_known),
        all: scores.all.bad[ONE_PIXEL].of_known,
    })
}

/// Share of the map's pixels with known truth that are wrong by over 2 px, 0 to 1; NaN without such pixels.
pub fn wrong(scene: &Scene, dense: &Dense) -> Result<f64, AnyError> {
    let scores = scene.score(&disparity::in_pixels(&dense.disparity))?;
    Ok(scores.all.bad[TWO_PIXELS].of_estimated)
}

/// Known disparities of the truth, in pixels, the smallest first.
pub fn known(scene: &Scene) -> Vec<f32> {
    let mut known: Vec<f32> = scene.truth.data().iter().copied().filter(|disparity| disparity.is_finite()).collect();
    known.sort_by(f32::total_cmp);
    known
}

/// The range from the first to the last of sorted disparities, rounded outwards to whole pixels.
pub fn range(sorted: &[f32]) -> Result<DisparityRange, AnyError> {
    let [Some(first), Some(last)] = [sorted.first(), sorted.last()] else {
        return Err("a scene without any known disparity: its truth must be finite somewhere".into());
    };
    Ok(DisparityRange::inclusive(first.floor() as i32, last.ceil() as i32)?)
}
