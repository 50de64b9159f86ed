//! Block matching of the other view: its winners confirm the matches of the reference view.

use super::Plan;
use crate::{
    dense::{
        config::DenseConfig,
        kernels::{BlockMatch, ConfirmingMap, Layout, MapBuffer, MapLayout, Ranges, ResultKind, Tile},
    },
    error::Result,
    gpu::{Gpu, WordTexture},
};

/// The block-matching kernel of the other view, and the memory of its winners.
pub(super) struct OtherWinners {
    find_winners: BlockMatch,
    winners: (wgpu::Buffer, WordTexture),
    layout: MapLayout,
    max_difference: u32,
}

impl OtherWinners {
    /// Allocates memory for the winners of a map of `layout`; `None` where `config` has no consistency check.
    pub(super) fn new(gpu: &Gpu, plan: &mut Plan, config: &DenseConfig, layout: MapLayout) -> Result<Option<Self>> {
        let Some(max_difference) = config.parameters.consistency else {
            return Ok(None);
        };
        let (view, tile) = (config.reference.other(), Tile::of(gpu, config.parameters.window()));
        Ok(Some(Self {
            find_winners: BlockMatch::new(gpu, &config.parameters, view, ResultKind::Winners, tile),
            winners: plan.words("winners of the other view", layout.pixels().into())?,
            layout,
            max_difference,
        }))
    }

    /// Plans block matching of the padded `planes` of `layout`. The matched band begins in row `first_row` of the map
    /// of winners.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        (layout, planes): (&Layout, &WordTexture),
        ranges: &Ranges,
        first_row: i32,
    ) -> ConfirmingMap<'_> {
        let (buffer, words) = &self.winners;
        plan.run(self.find_winners.prepare(layout, planes, ranges, None, MapBuffer { buffer, layout: self.layout }));
        plan.fill_texture(buffer, words);
        ConfirmingMap { words, width: layout.width(), first_row, max_difference: self.max_difference }
    }
}
