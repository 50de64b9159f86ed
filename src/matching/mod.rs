//! Correspondences between the features of two views (paper, step 4), on the host.
//!
//! descriptors -> nearest in Euclidean distance, both ways -> confidence from the ratio to a rival -> position refined
//! with the window of the dense half.

mod config;
mod nearest;
mod refine;

pub use config::MatchConfig;
pub(crate) use refine::{HALF, locate};
pub use refine::{Rows, Seed, refine};

use crate::{
    error::Result,
    features::Feature,
    matching::nearest::{Nearest, nearest},
};

/// A feature of the left view and the one of the right view that shows the same thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Index of the feature in the left view.
    pub left: usize,
    /// Index of the feature in the right view.
    pub right: usize,
    /// Euclidean distance of the two descriptors, 0 to 2.
    pub distance: f32,
    /// How far this match is ahead of its rivals, 0 (a rival is as near) to 1 (nothing else comes near).
    pub confidence: f32,
}

/// Matches the features of two views by their descriptors.
///
/// Sorted by confidence, the most confident first, equals by index; no feature occurs twice. Features whose
/// surroundings are flat (a descriptor of zeros) match nothing.
///
/// The confidence is one minus the ratio of the distances of the nearest descriptor and of its nearest rival (Lowe
/// 2004, section 7.1), where another detection of the same structure, next to the nearest one, is no rival. With
/// [`MatchConfig::mutual`] it is the lower of the confidences of the two directions.
///
/// # Errors
/// [`crate::Error::Parameter`] if the configuration is not valid.
pub fn match_features(left: &[Feature], right: &[Feature], config: &MatchConfig) -> Result<Vec<Match>> {
    config.validate()?;
    let forward = nearest(left, right, config);
    let backward = config.mutual.then(|| nearest(right, left, &config.swapped()));

    let mut matches: Vec<Match> = forward
        .into_iter()
        .enumerate()
        .filter_map(|(left, found)| {
            let found = found?;
            let mut ratio = ratio(&found);
            if let Some(backward) = &backward {
                ratio = ratio.max(mutual_ratio(backward[found.index], left)?);
            }
            (ratio <= config.ratio).then_some(Match {
                left,
                right: found.index,
                distance: found.distance,
                confidence: 1.0 - ratio,
            })
        })
        .collect();
    matches.sort_by(|a, b| b.confidence.total_cmp(&a.confidence).then(a.left.cmp(&b.left)).then(a.right.cmp(&b.right)));
    // Several features of the left view can have the same nearest one where matches need not be mutual.
    let mut taken = vec![false; right.len()];
    matches.retain(|found| !std::mem::replace(&mut taken[found.right], true));
    matches.truncate(config.strongest.unwrap_or(usize::MAX));
    Ok(matches)
}

/// The ratio of the way back, if it leads to `left`.
fn mutual_ratio(back: Option<Nearest>, left: usize) -> Option<f32> {
    back.filter(|back| back.index == left).map(|back| ratio(&back))
}

/// Distance of the nearest by that of its rival, 0 to 1.
fn ratio(found: &Nearest) -> f32 {
    /// Unrelated descriptors are hardly ever further apart, so a match without any rival is judged against this.
    const UNRELATED: f32 = 1.0;
    let rival = found.rival.min(UNRELATED);
    if found.distance < rival { found.distance / rival } else { 1.0 }
}
