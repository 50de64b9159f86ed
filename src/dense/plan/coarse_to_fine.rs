//! Coarse to fine: the ranges of cells, found in half-size pictures.
//!
//! halving, once -> per band of rows: padding or soft ranks -> winners of the other view -> block matching of the reference view ->
//! ranges of the band's cells.

use super::{Plan, compared::ComparedBytes, other_winners::OtherWinners};
use crate::{
    dense::{
        config::DenseConfig,
        kernels::{
            BlockMatch, CELL, CellBand, CellRanges, ConfirmingMap, Halve, Layout, MapBuffer, MapLayout, REACH, Ranges,
            Tile, halved_config,
        },
    },
    disparity::DisparityRange,
    error::Result,
    gpu::{Gpu, WordTexture},
    image::Size,
    luma::packed_bytes,
};

/// Kernels and memory of the half-size search.
pub(super) struct Coarse {
    size: Size,
    tile: Tile,
    range: DisparityRange,
    half: DenseConfig,
    cell_ranges: CellRanges,
    /// Packed luma of the half-size pictures, left and right.
    halves: [wgpu::Buffer; 2],
    planes: (wgpu::Buffer, WordTexture),
    map: wgpu::Buffer,
    other_winners: Option<OtherWinners>,
    /// Searched disparities: of the half-size pictures, and of the cells.
    whole: Ranges,
    ranges: Ranges,
}

impl Coarse {
    /// Allocates memory for bands of `band_rows` rows, and plans the halving of both `pictures`.
    pub(super) fn new(
        gpu: &Gpu,
        plan: &mut Plan,
        size: Size,
        config: &DenseConfig,
        pictures: [&wgpu::Buffer; 2],
        band_rows: u32,
    ) -> Result<Self> {
        let Size { width, height } = size;
        let range = config.searched(width)?;
        let half_size = Size::new(width.div_ceil(2), height.div_ceil(2));
        let half = halved_config(config, range);
        let half = DenseConfig { range: half.searched(half_size.width)?, ..half };
        let halve = Halve::new(gpu);
        let [left, right] = pictures.map(|picture| -> Result<wgpu::Buffer> {
            let halved = plan.buffer("half the picture", packed_bytes(half_size) / 4)?;
            plan.run(halve.prepare(size, picture, &halved));
            Ok(halved)
        });
        // A band in the middle of the picture reads the most rows.
        let most_rows = (band_rows.next_multiple_of(CELL) / 2 + REACH).min(half_size.height);
        let tile = Tile::of(gpu, config.parameters.window());
        let planes = plan.words("padded halves", Layout::new(half_size, 0, most_rows, &half, tile)?.words())?;
        let map_layout = MapLayout { width: half_size.width, rows: most_rows };
        let map = plan.buffer("map of half the size", map_layout.words())?;
        let words = CellBand::new(size, (0, band_rows), range).words();
        let ranges = Ranges::of_cells(plan.buffer("ranges of cells", words)?, width);
        Ok(Self {
            size,
            tile,
            range,
            whole: Ranges::whole(gpu, half.range),
            half,
            cell_ranges: CellRanges::new(gpu),
            halves: [left?, right?],
            planes,
            map,
            other_winners: OtherWinners::new(gpu, plan, config, map_layout)?,
            ranges,
        })
    }

    /// Plans the ranges of the reference view's cells in `rows` (first row, number of rows), and the winners of the
    /// other view where a consistency check needs them.
    pub(super) fn plan(
        &self,
        plan: &mut Plan,
        bytes: &ComparedBytes,
        block_match: &BlockMatch,
        rows: (u32, u32),
    ) -> Result<(&Ranges, Option<ConfirmingMap<'_>>)> {
        let band = CellBand::new(self.size, rows, self.range);
        let half_size = Size::new(band.map_width, self.size.height.div_ceil(2));
        let layout = Layout::new(half_size, band.map_first_row, band.map_rows, &self.half, self.tile)?;
        bytes.plan(plan, &layout, self.halves.each_ref(), &self.planes);
        let confirming = self
            .other_winners
            .as_ref()
            .map(|other| other.plan(plan, (&layout, &self.planes.1), &self.whole, band.map_start));
        let map = MapBuffer { buffer: &self.map, layout: MapLayout { width: band.map_width, rows: band.map_rows } };
        plan.run(block_match.prepare(&layout, &self.planes.1, &self.whole, None, map));
        plan.run(self.cell_ranges.prepare(&band, &self.map, &self.ranges.buffer));
        Ok((&self.ranges, confirming))
    }
}
