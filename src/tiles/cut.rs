//! What a tile is matched from, cut from a pair.

use super::plan::{Area, Tile, levels};
use crate::{
    backend::Backend,
    dense::{Aggregation, Dense, DenseConfig, Search, Seen, View, kernels::Loss},
    error::Result,
    image::{Luma, Size},
    io::Picture,
    mask::Mask,
    pair::Pair,
};

/// A prepared pair of which tiles are cut.
pub(crate) struct Whole<'a> {
    pub luma: [&'a Luma; 2],
    /// The picture of the reference view, by whose colours holes are filled.
    pub colours: Option<&'a Picture>,
    /// Which pixels of the reference view and of the other one show the scene; `None`: all do.
    pub masks: [Option<&'a Mask>; 2],
    pub loss: Loss,
    pub config: &'a DenseConfig,
}

/// The views of a tile, with all that its disparities depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct TilePair {
    /// Its place in the picture.
    pub tile: Tile,
    /// Luma of the left and of the right view.
    pub luma: [Luma; 2],
    /// The picture of the reference view, by whose colours holes are filled; by its luma, if there is none.
    pub colours: Option<Picture>,
    /// Which pixels of the reference view and of the other one show the scene: 255 or 0; `None`: all do.
    pub masks: [Option<Luma>; 2],
    /// Whether a pixel whose partner is hidden keeps its disparity until holes are filled: of pairs that were rectified.
    pub keeps_hidden: bool,
    /// The parameters, with the bounds of the range and the brightness of the whole pair.
    pub config: DenseConfig,
}

impl Whole<'_> {
    pub fn size(&self) -> Size {
        self.luma[0].size()
    }

    pub fn cut(&self, tile: Tile) -> TilePair {
        let part = |plane: &Luma| tile.view.cut(plane);
        TilePair {
            tile,
            luma: self.luma.map(part),
            colours: self.colours.map(|picture| tile.view.cut(picture)),
            masks: self.masks.map(|mask| mask.map(part)),
            keeps_hidden: matches!(self.loss, Loss::Nothing),
            config: of_tiles(self.config, self.size()),
        }
    }
}

/// The parameters of the tiles of a picture of `size` that is matched by `config`.
pub(super) fn of_tiles(config: &DenseConfig, size: Size) -> DenseConfig {
    let levels = levels(config, size);
    config.clone().with(|parameters| {
        if let Aggregation::Costs(costs) = &mut parameters.aggregation {
            costs.search = if levels == 1 { Search::Whole } else { Search::Levels(levels) };
        }
    })
}

impl TilePair {
    /// Matches the tile: disparities and confidences of its core.
    ///
    /// # Errors
    /// See [`crate::dense::compute`].
    pub async fn dense(&self, backend: &Backend) -> Result<Dense> {
        self.dense_with_progress(backend, |_| ()).await
    }

    /// [`Self::dense`] with calls of `progress` with the share of the work that a device has done, 0 to 1.
    pub(crate) async fn dense_with_progress(&self, backend: &Backend, progress: impl FnMut(f32)) -> Result<Dense> {
        let reference = usize::from(self.config.reference == View::Right);
        let mut pictures = [None; 2];
        pictures[reference] = self.colours.as_ref();
        let pair = Pair::with_known_luma(backend, self.luma.clone(), pictures).await?;
        let loss = if self.keeps_hidden { Loss::Nothing } else { Loss::Disparity };
        let masks = self.masks.each_ref().map(Option::as_ref);
        let is_masked = masks.iter().any(Option::is_some) && self.config.parameters.refinement.is_some();
        let dense = pair.dense_seen(&self.config, is_masked.then_some(Seen { masks, loss }), progress).await?;
        let Tile { core, view } = self.tile;
        let core = Area { x: core.x - view.x, y: core.y - view.y, ..core };
        Ok(Dense { disparity: core.cut(&dense.disparity), confidence: core.cut(&dense.confidence) })
    }
}
