//! Matching of the features of two views (paper, step 4), on the host.
//!
//! descriptors -> nearest neighbours in Euclidean distance, in both directions -> confidence from the ratio test ->
//! position refined by block matching.

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

/// A match between a feature of the left view and a feature of the right view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Index of the feature in the left view.
    pub left: usize,
    /// Index of the feature in the right view.
    pub right: usize,
    /// Euclidean distance of the two descriptors, 0 to 2.
    pub distance: f32,
    /// Confidence of the match: 0 (a rival is as near) to 1 (no rival comes near).
    pub confidence: f32,
}

/// Matches the features of two views by their descriptors.
///
/// The matches are sorted by confidence, the most confident first, equal ones by index; no feature occurs twice.
/// Features in flat surroundings (a descriptor of zeros) match nothing.
///
/// The confidence is one minus the ratio of the distances of the nearest descriptor and of its nearest rival (Lowe
/// 2004, section 7.1). Another detection of the same structure, next to the nearest feature, is no rival. With
/// [`MatchConfig::mutual`] the confidence is the lower one of the two directions.
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
    // Without `mutual`, several features of the left view can share a nearest feature.
    let mut taken = vec![false; right.len()];
    matches.retain(|found| !std::mem::replace(&mut taken[found.right], true));
    matches.truncate(config.strongest.unwrap_or(usize::MAX));
    Ok(matches)
}

/// Ratio of the backward match, if it leads to `left`.
fn mutual_ratio(back: Option<Nearest>, left: usize) -> Option<f32> {
    back.filter(|back| back.index == left).map(|back| ratio(&back))
}

/// Distance of the nearest descriptor divided by that of its rival, at most 1.
fn ratio(found: &Nearest) -> f32 {
    /// Distance that unrelated descriptors rarely exceed; takes the place of the rival if there is none.
    const UNRELATED: f32 = 1.0;
    let rival = found.rival.min(UNRELATED);
    if found.distance < rival { found.distance / rival } else { 1.0 }
}
