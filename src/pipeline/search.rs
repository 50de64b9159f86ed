//! The dense search of prepared views, over a wider range where surfaces go on.

use super::{
    range::{RangeSource, at_ends, widened},
    views::Views,
};
use crate::{
    config::{Config, Method},
    dense::{Brightness, Dense, DenseConfig, View},
    disparity::DisparityRange,
    error::Result,
    io::Picture,
    kamencay::KamencayConfig,
    tiles::{Merged, Tiling},
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
    /// See [`super::Outcome::at_ends`].
    pub at_ends: [f32; 2],
}

impl Found {
    /// What a search of `range` found in the `reference` view.
    pub fn new(views: &Views<'_>, range: DisparityRange, dense: Dense, reference: View) -> Self {
        let dense = views.confirmed(dense, reference);
        let at_ends = at_ends(&views.with_partners(&dense, reference), range);
        Self { range, dense, at_ends }
    }
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
                let task = DenseConfig { range, ..task };
                let dense = match config.tiles {
                    Some(tiling) => self.in_tiles(tiling, &task, progress).await?,
                    None => views.dense(&task, progress).await?,
                };
                (range, dense)
            }
            Method::Kamencay(parameters) => {
                let task = config.kamencay(parameters, range, brightness);
                let range = task.searched(width)?;
                let [left, right] = views.pictures(self.pictures);
                let backend = views.pair.backend();
                (range, backend.kamencay(&left, &right, &KamencayConfig { range, ..task }).await?)
            }
        };
        Ok(Found::new(views, range, dense, config.reference))
    }

    /// The map of all tiles, each matched by itself. Calls `progress` with the share of the work that is done, 0 to 1.
    async fn in_tiles(&self, tiling: Tiling, task: &DenseConfig, mut progress: impl FnMut(f32)) -> Result<Dense> {
        let Self { views, pictures, .. } = *self;
        let whole = views.whole(pictures, task);
        let tiles = tiling.tiles(views.size(), task);
        let mut merged = Merged::new(views.size());
        for (number, tile) in tiles.iter().enumerate() {
            let of_all = |share| (number as f32 + share) / tiles.len() as f32;
            let backend = views.pair.backend();
            let found = whole.cut(*tile).dense_with_progress(backend, |share| progress(of_all(share))).await?;
            merged.put(tile, &found)?;
        }
        Ok(merged.into_dense())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        backend::Backend,
        config::Preset,
        disparity::{NONE, SCALE},
        gpu::block_on,
        image::{Luma, Plane},
    };

    #[test]
    fn partners_that_the_other_view_does_not_show_are_at_no_end() {
        let size = (64, 32);
        let shade = |x: u32, y: u32, alpha| [(x * 37 + y * 11) as u8, 90, 40, alpha];
        let left = Picture::from_fn(size, |x, y| shade(x, y, 255));
        let right = Picture::from_fn(size, |x, y| shade(x, y, if x < 40 { 255 } else { 0 }));
        let backend = Backend::Cpu;
        let views = block_on(Views::new(&backend, [&left, &right], &Preset::Fast.config())).unwrap();
        // Of the rightmost 24 columns the partners at 2 px are hidden from column 42 on; those of the other columns lie at 8 px.
        let disparity = Plane::from_fn(size, |x, _| if x < 40 { 8 * SCALE } else { 2 * SCALE });
        let dense = Dense { disparity, confidence: Luma::filled(size, 200) };
        let range = DisparityRange::inclusive(2, 20).unwrap();
        let Found { dense, at_ends, .. } = Found::new(&views, range, dense, View::Left);
        assert_eq!(at_ends, [2.0 / 42.0, 0.0]);
        assert_eq!((dense.disparity.get(60, 3), dense.confidence.get(60, 3)), (2 * SCALE, 0), "hidden, and not lost");
        assert!(!dense.disparity.data().contains(&NONE));
    }
}
