//! The map of one view.

use super::config::FILLED;
use crate::{disparity::DisparityMap, image::Plane};

/// A disparity map of the reference view, and its confidences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    /// Disparities in 1/256 px, or [`crate::disparity::NONE`].
    pub disparity: DisparityMap,
    /// Confidence of each disparity, above [`FILLED`] and up to 255 where it was measured, 1 to [`FILLED`] in filled holes, 0
    /// for no disparity. Without refinement, the margin of the winner's cost below its best rival's, as a share of the rival's
    /// cost. With refinement, up to 245: the number of surrounding pixels with a similar disparity, less where the views differ;
    /// in filled holes, less where the surface that fills it is farther away or differs in colour.
    pub confidence: Plane<u8>,
}

impl Dense {
    /// Share of pixels with a measured disparity, 0 to 1: neither none nor filled.
    pub fn measured(&self) -> f64 {
        let confidences = self.confidence.data();
        confidences.iter().filter(|&&confidence| confidence > FILLED).count() as f64 / confidences.len() as f64
    }

    /// Share of pixels with a filled disparity, 0 to 1.
    pub fn filled(&self) -> f64 {
        let confidences = self.confidence.data();
        confidences.iter().filter(|confidence| (1..=FILLED).contains(confidence)).count() as f64
            / confidences.len() as f64
    }
}
