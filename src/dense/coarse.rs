//! Coarse to fine: what is worth searching in each cell, found in pictures of half the size.
//!
//! halving, once -> and in each band of rows: padding -> block matching of the reference view -> the ranges of its
//! cells -> those of the other view's cells.

use super::{
    block_match::{BlockMatch, Layout, Tile},
    cell_ranges::CellRanges,
    cells::{CELL, CellBand, REACH, Ranges, halved_config},
    config::{DenseConfig, View},
    halve::Halve,
    pad::Pad,
    partner_ranges::PartnerRanges,
    plan::{Plan, match_words},
};
use crate::{
    disparity::DisparityRange,
    error::Result,
    gpu::{Context, WordTexture},
    luma::packed_bytes,
};

/// The kernels and the memory of the search at half the size.
pub(super) struct Coarse {
    size: (u32, u32),
    range: DisparityRange,
    view: View,
    half: DenseConfig,
    cell_ranges: CellRanges,
    /// Left and right picture of half the size.
    halves: [wgpu::Buffer; 2],
    planes: (wgpu::Buffer, WordTexture),
    map: wgpu::Buffer,
    /// What is searched at half the size, in the reference view's cells, and in the other's, where it is asked.
    whole: Ranges,
    ranges: Ranges,
    partners: Option<(PartnerRanges, Ranges)>,
}

impl Coarse {
    /// Allocates memory for bands of `band_rows` rows, and plans the halving of `pictures`.
    pub(super) fn new(
        device: &Context<'_>,
        plan: &mut Plan,
        size: (u32, u32),
        config: &DenseConfig,
        pictures: [&wgpu::Buffer; 2],
        band_rows: u32,
    ) -> Result<Self> {
        let (width, height) = size;
        let range = config.searched(width)?;
        let half_size = (width.div_ceil(2), height.div_ceil(2));
        let half = halved_config(config, range);
        let half = DenseConfig { range: half.searched(half_size.0)?, ..half };
        let halve = Halve::new(device);
        let [left, right] = pictures.map(|picture| -> Result<wgpu::Buffer> {
            let halved = plan.buffer(device, "half the picture", packed_bytes(half_size.0, half_size.1) / 4)?;
            plan.run(halve.prepare(device, size, picture, &halved));
            Ok(halved)
        });
        // No band looks at more rows than one in the midst of the picture.
        let most_rows = (band_rows.next_multiple_of(CELL) / 2 + REACH).min(half_size.1);
        let tile = Tile::of(device);
        let planes = plan.words(device, "padded halves", Layout::new(half_size, 0, most_rows, &half, tile)?.words())?;
        let map = plan.buffer(device, "map of half the size", match_words(half_size.0, most_rows).0)?;
        let words = CellBand::new(size, (0, band_rows), range).words();
        let ranges = |plan: &mut Plan| -> Result<Ranges> {
            let buffer = plan.buffer(device, "ranges of cells", words)?;
            Ok(Ranges::of_cells(buffer, width))
        };
        let ranges_of_view = ranges(plan)?;
        let partners = match config.consistency {
            Some(_) => Some((PartnerRanges::new(device), ranges(plan)?)),
            None => None,
        };
        Ok(Self {
            size,
            range,
            view: config.reference,
            whole: Ranges::whole(device, half.range),
            half,
            cell_ranges: CellRanges::new(device),
            halves: [left?, right?],
            planes,
            map,
            ranges: ranges_of_view,
            partners,
        })
    }

    /// Plans what finds the ranges of the reference view's cells, and of the other's where it is asked, for some rows.
    pub(super) fn plan(
        &self,
        device: &wgpu::Device,
        plan: &mut Plan,
        pad: &Pad,
        block_match: &BlockMatch,
        rows: (u32, u32),
    ) -> Result<(&Ranges, Option<&Ranges>)> {
        let band = CellBand::new(self.size, rows, self.range);
        let half_size = (band.map_width, self.size.1.div_ceil(2));
        let tile = Tile::of(device);
        let layout = Layout::new(half_size, band.map_first_row, band.map_rows, &self.half, tile)?;
        for ((params, view), half) in layout.padding().into_iter().zip(View::BOTH).zip(&self.halves) {
            plan.run(pad.prepare(device, params, &plan.brightness(view), half, &self.planes.0));
        }
        plan.fill_texture(&self.planes.0, &self.planes.1);
        let confidence_offset = match_words(band.map_width, band.map_rows).1;
        plan.run(block_match.prepare(
            device,
            &layout,
            &self.planes.1,
            &self.whole,
            None,
            (&self.map, confidence_offset),
        ));
        let ranges = &self.ranges.buffer;
        plan.run(self.cell_ranges.prepare(device, &band, &self.map, ranges));
        let partners = self.partners.as_ref().map(|(kernel, partners)| {
            plan.run(kernel.prepare(device, &band, self.view, ranges, &partners.buffer));
            partners
        });
        Ok((&self.ranges, partners))
    }
}
