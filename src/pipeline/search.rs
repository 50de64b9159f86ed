//! The dense search of prepared views, over a wider range where surfaces go on.

use super::{
    range::{RangeSource, at_ends, widened},
    views::Views,
};
use crate::{
    config::{Config, Method},
    dense::{Brightness, Dense, DenseConfig},
    disparity::DisparityRange,
    error::Result,
    io::Picture,
    kamencay::KamencayConfig,
};

/// Largest number of searches, each over a wider range than the one before.
const SEARCHES: u32 = 3;

/// A task without its range.
pub(super) struct Search<'a, 'b> {
    pub views: &'a Views<'b>,
    /// The pictures as given: their colours guide the filling of holes, and Kamencay's method takes them.
    pub pictures: [&'a Picture; 2],
    pub config: &'a Config,
    pub brightness: Brightness,
}

/// A map and the range that was searched for it.
pub(super) struct Found {
    /// The range, without what the width of the views rules out.
    pub range: DisparityRange,
    pub dense: Dense,
    /// Shares of the map's disparities at the ends of the range.
    pub at_ends: [f32; 2],
}

impl Search<'_, '_> {
    /// Searches `range`, and wider ranges while the map touches an end of a range that was found.
    /// Calls `progress` with the share of a search that is done, 0 to 1.
    pub async fn widening(
        &self,
        mut range: DisparityRange,
        source: RangeSource,
        mut progress: impl FnMut(f32),
    ) -> Result<Found> {
        let width = self.views.size().width;
        for _ in 1..SEARCHES {
            let found = self.once(range, &mut progress).await?;
            match widened(found.range, source, found.at_ends, self.config.least, width) {
                Some(wider) => range = wider,
                None => return Ok(found),
            }
        }
        self.once(range, &mut progress).await
    }

    async fn once(&self, range: DisparityRange, progress: impl FnMut(f32)) -> Result<Found> {
        let Self { views, config, brightness, .. } = *self;
        let width = views.size().width;
        let (range, dense) = match &config.method {
            Method::Hsad(parameters) => {
                let task = config.dense(parameters, range, brightness);
                let range = task.searched(width)?;
                (range, views.dense(&DenseConfig { range, ..task }, progress).await?)
            }
            Method::Kamencay(parameters) => {
                let task = config.kamencay(parameters, range, brightness);
                let range = task.searched(width)?;
                let [left, right] = views.pictures(self.pictures);
                let backend = views.pair.backend();
                (range, backend.kamencay(&left, &right, &KamencayConfig { range, ..task }).await?)
            }
        };
        let dense = views.confirmed(dense, config.reference);
        Ok(Found { range, at_ends: at_ends(&dense.disparity, range), dense })
    }
}
