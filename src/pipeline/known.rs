//! What is known of a pair before it is matched densely, and the map that comes of it.

use super::{
    Given, Outcome,
    confidence::{by_detail, in_proportion, without_constant, without_ends},
    no_depth::NoDepth,
    range::RangeSource,
    search::{Found, Search},
    trust::{of_steps, shows_no_parallax, trust},
    views::Views,
};
use crate::{
    config::{Config, Method},
    dense::{Brightness, View},
    disparity::DisparityRange,
    error::Result,
    features::Feature,
    filter::repetition,
    seeding::Seeding,
};

/// What is known of a pair before it is matched densely.
pub(super) struct Known {
    pub features: [Vec<Feature>; 2],
    pub points_found: [usize; 2],
    pub seeding: Seeding,
    pub range: DisparityRange,
    pub range_source: RangeSource,
    /// Whether a wider range is searched if the map touches an end of the range.
    pub widens: bool,
    pub brightness: Brightness,
    /// See [`Outcome::repetition`].
    pub repetition: u32,
    /// Factor by which the views were reduced for their features.
    pub factor: u32,
}

/// See [`Outcome::repetition`].
pub(super) fn repetition_of(views: &Views<'_>) -> u32 {
    let (left, right) = views.pair.views();
    repetition(left).min(repetition(right))
}

/// The change of the right view's brightness that `seeding` tells, if `config` equalises.
pub(super) fn brightness(config: &Config, seeding: &Seeding) -> Brightness {
    match seeding.brightness {
        Some(found) if config.equalise => found.equalising(),
        _ => Brightness::SAME,
    }
}

impl Known {
    /// Matches `views`, whose rows are aligned, densely; the outcome has no times.
    pub async fn matched(
        self,
        views: Views<'_>,
        given: &Given<'_>,
        config: &Config,
        progress: impl FnMut(f32),
    ) -> Result<Outcome> {
        let views = views.drowned().await?;
        let search = Search { views: &views, pictures: given.pictures, config, brightness: self.brightness };
        let may_widen = if self.widens { self.range_source } else { RangeSource::Asked };
        let found = search.widening(self.range, may_widen, progress).await?;
        Ok(self.outcome(views, given, config, found))
    }

    /// The outcome with the map that was found; it has no times.
    pub fn outcome(self, views: Views<'_>, given: &Given<'_>, config: &Config, found: Found) -> Outcome {
        let Self { features, points_found, seeding, range_source, brightness, repetition, factor, .. } = self;
        let (size, Found { range, dense, at_ends }) = (views.size(), found);
        let dense = without_ends(dense, range, range_source.ends_at_zero());
        let (left, right) = views.pair.views();
        let own = if config.reference == View::Left { left } else { right };
        let dense = without_constant(dense, own);
        let no_depth = match given.rectified.and_then(|pair| pair.rectification.calibration()) {
            _ if shows_no_parallax(&dense) => Some(NoDepth::NoParallax),
            Some(_) => None,
            None => NoDepth::of(&seeding.seeds, &seeding.rectification.rows, size, factor),
        };
        let dense = match config.method {
            Method::Hsad(_) => by_detail(dense, own),
            // Its confidences tell how alike the views look, and not how many neighbours agree.
            Method::Kamencay(_) => dense,
        };
        let trust = if no_depth.is_some() { 0.0 } else { trust(&dense, config, &seeding) * of_steps(repetition) };
        let dense = in_proportion(dense, trust);
        Outcome {
            features,
            points_found,
            reduction: factor,
            no_depth,
            trust,
            seeding,
            range,
            range_source,
            at_ends,
            brightness,
            masks: views.masks,
            mosaics: given.rectified.map_or(views.mosaics, |pair| pair.mosaics),
            repetition,
            dense,
            times: Vec::new(),
        }
    }
}
