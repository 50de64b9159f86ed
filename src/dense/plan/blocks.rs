//! Block matching: the plan.
//!
//! padding -> the other view's winners -> block matching of the reference view, which they confirm; in bands of rows
//! where the padded planes do not fit in a buffer; no result depends on where they are cut. Coarse to fine, each band
//! finds the ranges of its cells and the other view's winners first, at half the size: see [`super::coarse`].

use super::{
    BandLimits, Plan,
    coarse_to_fine::Coarse,
    other_winners::OtherWinners,
    refine::{Unrefined, plan_refinement},
};
use crate::{
    dense::{
        config::{DenseConfig, Search, View},
        kernels::{BlockMatch, CELL, Layout, MapBuffer, MapLayout, Pad, Ranges, ResultKind, Tile, Views},
    },
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, in_rows, most_words},
    image::Size,
};

/// More rows than this are never matched at once, to stay below 65,535 workgroups.
const MAX_BAND_ROWS: u32 = 8192;

/// Nor are more pixel-disparities: a device that also draws the desktop is taken away from a dispatch
/// that takes seconds, and slow ones do 10^9 of them in about one.
const MAX_BAND_WORK: u64 = 1 << 30;

/// The plan for packed `left` and `right` of `size`, in bands within `limits`.
pub(in crate::dense) fn plan(
    gpu: &Gpu,
    size: Size,
    config: &DenseConfig,
    search: Search,
    [left, right]: [&wgpu::Buffer; 2],
    limits: BandLimits,
) -> Result<Plan> {
    let Size { width, height } = size;
    let tile = Tile::of(gpu);
    let unit = if search == Search::CoarseToFine { CELL.min(height) } else { 1 };
    let band_rows = band_rows_within(limits, 4 * most_words(gpu), size, config, tile, unit)?;
    let view = config.reference;
    let pad = Pad::new(gpu);
    let block_match = BlockMatch::new(gpu, &config.parameters, view, ResultKind::Matches, tile);

    let mut plan = Plan::new(gpu, config, height.div_ceil(band_rows) as usize);
    let whole = config.parameters.refinement.map(|_| plan.collect(size)).transpose()?;
    let map = MapLayout { width, rows: band_rows };
    let planes = plan.words("padded planes", Layout::new(size, 0, band_rows, config, tile)?.words())?;
    let matches = plan.buffer("matches", map.words())?;
    let matches = MapBuffer { buffer: &matches, layout: map };
    let whole_range = Ranges::whole(gpu, config.searched(width)?);
    let (coarse, other_winners) = match search {
        Search::Whole => (None, OtherWinners::new(gpu, &mut plan, config, map)?),
        Search::CoarseToFine => (Some(Coarse::new(gpu, &mut plan, size, config, [left, right], band_rows)?), None),
    };

    for first_row in (0..height).step_by(band_rows as usize) {
        let rows = band_rows.min(height - first_row);
        let layout = Layout::new(size, first_row, rows, config, tile)?;
        let (ranges, others) = match &coarse {
            None => (&whole_range, None),
            Some(coarse) => coarse.plan(&mut plan, &pad, &block_match, (first_row, rows))?,
        };
        for ((params, view), picture) in layout.padding().into_iter().zip(View::ALL).zip([left, right]) {
            plan.run(pad.prepare(params, &plan.brightness(view), picture, &planes.0));
        }
        plan.fill_texture(&planes.0, &planes.1);
        let others = match &other_winners {
            None => others,
            Some(view) => Some(view.plan(&mut plan, (&layout, &planes.1), ranges, 0)),
        };
        plan.run(block_match.prepare(&layout, &planes.1, ranges, others, matches));
        plan.hand_out(matches, first_row, rows);
    }
    if let (Some(map), Some(refinement)) = (&whole, &config.parameters.refinement) {
        let views = Views { luma: [left, right], brightness: &plan.brightness(View::Right), reference: view };
        let range = config.searched(width)?;
        plan_refinement(gpu, &mut plan, refinement, Unrefined { map, size, range, views }, limits)?;
    }
    Ok(plan)
}

/// The most rows, up to `wanted` and in whole `unit`s, for which every buffer of a band stays within `limit` bytes, every
/// texture within `texture_limit`, and its work within a second or so.
fn band_rows_within(
    BandLimits { bytes: limit, rows: wanted }: BandLimits,
    texture_limit: u64,
    size: Size,
    config: &DenseConfig,
    tile: Tile,
    unit: u32,
) -> Result<u32> {
    let Size { width, height } = size;
    let work = u64::from(width) * u64::from(config.searched(width)?.count);
    let quick = u32::try_from(MAX_BAND_WORK / work).unwrap_or(u32::MAX);
    let whole_units = |rows: u32| if rows >= height { height } else { (rows / unit * unit).max(unit) };
    let mut rows = whole_units(wanted.min(quick).clamp(1, height.min(MAX_BAND_ROWS)));
    loop {
        let planes = 4 * in_rows(Layout::new(size, 0, rows, config, tile)?.words());
        let map = MapLayout { width, rows };
        let matches = 4 * map.words();
        // Those of the other view, which stand in a texture.
        let winners = if config.parameters.consistency.is_some() { 4 * in_rows(map.pixels().into()) } else { 0 };
        let over = [(planes, limit.min(texture_limit)), (matches, limit), (winners, limit.min(texture_limit))]
            .into_iter()
            .find(|(needed, limit)| needed > limit);
        let Some((needed, limit)) = over else {
            return Ok(rows);
        };
        if rows == unit {
            return Err(Error::TooLarge {
                what: format!("{unit} rows of a picture {width} px wide with {} disparities", config.range.count),
                needed,
                limit,
                way_out: format!(
                    "search fewer disparities, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"
                ),
            });
        }
        rows = whole_units(rows.div_ceil(2));
    }
}
