//! Block matching of the other view: its winners, which confirm the matches of the reference view.

use super::Plan;
use crate::{
    dense::{
        config::DenseConfig,
        kernels::{BlockMatch, Layout, OtherMap, Ranges, Tile, Wanted},
    },
    error::Result,
    gpu::{Gpu, WordTexture},
};

/// The kernel that finds them, and the memory that they stand in.
pub(super) struct OtherView {
    find_winners: BlockMatch,
    winners: (wgpu::Buffer, WordTexture),
    max_difference: u32,
}

impl OtherView {
    /// Allocates memory for the winners of so many pixels; none where `config` does not ask for them.
    pub(super) fn new(gpu: &Gpu, plan: &mut Plan, config: &DenseConfig, pixels: u64) -> Result<Option<Self>> {
        let Some(max_difference) = config.consistency else {
            return Ok(None);
        };
        let (view, tile) = (config.reference.other(), Tile::of(gpu));
        Ok(Some(Self {
            find_winners: BlockMatch::new(gpu, config, view, Wanted::Winners, tile),
            winners: plan.words("winners of the other view", pixels)?,
            max_difference,
        }))
    }

    /// Plans the search of the padded `planes` of `layout`. The matched band begins in row `first_row` of the map.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        (layout, planes): (&Layout, &WordTexture),
        ranges: &Ranges,
        first_row: i32,
    ) -> OtherMap<'_> {
        let (buffer, words) = &self.winners;
        plan.run(self.find_winners.prepare(layout, planes, ranges, None, (buffer, 0)));
        plan.fill_texture(buffer, words);
        OtherMap { words, width: layout.width(), first_row, max_difference: self.max_difference }
    }
}
