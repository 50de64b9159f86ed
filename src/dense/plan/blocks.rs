//! Block matching: the plan.
//!
//! padding or soft ranks -> winners of the other view -> block matching of the reference view, which those winners confirm. The pair
//! is matched in bands of rows where its padded planes exceed the buffer limits; the result does not depend on where
//! bands are cut. Coarse to fine, each band first finds the ranges of its cells and the winners of the other view at
//! half the size: see [`super::coarse_to_fine`].

use super::{
    BandLimits, Plan,
    coarse_to_fine::Coarse,
    compared::ComparedBytes,
    other_winners::OtherWinners,
    refine::{After, StoredMap, Unrefined, plan_after_bands},
};
use crate::{
    dense::{
        config::{Compared, DenseConfig, Search},
        kernels::{BlockMatch, CELL, Layout, MapBuffer, MapLayout, Ranges, ResultKind, Tile},
        uploaded::UploadedPair,
    },
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, in_rows, most_words},
    image::Size,
};

/// Most rows of a band, to stay below 65,535 workgroups.
const MAX_BAND_ROWS: u32 = 8192;

/// Most pixel-disparities of a band: a slow device matches 10^9 of them in about 1 s, and longer dispatches can trip
/// the watchdog of a GPU that drives a display.
const MAX_BAND_WORK: u64 = 1 << 30;

/// Plans block matching of packed `left` and `right` of `size`, in bands within `limits`; holes are filled by the `colours` of
/// the reference view.
pub(in crate::dense) fn plan(
    gpu: &Gpu,
    size: Size,
    config: &DenseConfig,
    (search, compared): (Search, Compared),
    pair: &UploadedPair,
    limits: BandLimits,
) -> Result<Plan> {
    let Size { width, height } = size;
    let [left, right] = &pair.luma;
    let tile = Tile::of(gpu, config.parameters.window());
    let unit = if search == Search::CoarseToFine { CELL.min(height) } else { 1 };
    let band_rows = band_rows_within(limits, 4 * most_words(gpu), size, config, tile, unit)?;
    let view = config.reference;
    let bytes = ComparedBytes::new(gpu, compared);
    let block_match = BlockMatch::new(gpu, &config.parameters, view, ResultKind::Matches, tile);

    let mut plan = Plan::new(gpu, config, height.div_ceil(band_rows) as usize);
    let goes_on = config.parameters.goes_on() || pair.masks.is_some();
    if goes_on {
        plan.keep(size)?;
    }
    let map = MapLayout { width, rows: band_rows };
    let planes = plan.words("padded planes", Layout::new(size, 0, band_rows, config, tile)?.words())?;
    let matches = plan.buffer("matches", map.words())?;
    let matches = MapBuffer { buffer: &matches, layout: map };
    let whole_range = Ranges::whole(gpu, config.searched(width)?);
    let (coarse, other_winners) = match search {
        Search::Whole | Search::Levels(_) => (None, OtherWinners::new(gpu, &mut plan, config, map)?),
        Search::CoarseToFine => (Some(Coarse::new(gpu, &mut plan, size, config, [left, right], band_rows)?), None),
    };

    for first_row in (0..height).step_by(band_rows as usize) {
        let rows = band_rows.min(height - first_row);
        let layout = Layout::new(size, first_row, rows, config, tile)?;
        let (ranges, confirming) = match &coarse {
            None => (&whole_range, None),
            Some(coarse) => coarse.plan(&mut plan, &bytes, &block_match, (first_row, rows))?,
        };
        bytes.plan(&mut plan, &layout, [left, right], &planes);
        let confirming = match &other_winners {
            None => confirming,
            Some(view) => Some(view.plan(&mut plan, (&layout, &planes.1), ranges, 0)),
        };
        plan.run(block_match.prepare(&layout, &planes.1, ranges, confirming, matches));
        plan.hand_out(matches, first_row, rows);
    }
    if goes_on {
        let map = matches.buffer;
        let range = config.searched(width)?;
        let after = After::of(&config.parameters);
        let unrefined = Unrefined { map: StoredMap::of(&plan, map), size, range, pair, reference: view };
        plan_after_bands(gpu, &mut plan, &after, unrefined, limits)?;
    }
    Ok(plan)
}

/// The most rows of a band, up to `max_rows` and in whole `unit`s, with every buffer within `limit` bytes, every
/// texture within `texture_limit` bytes, and at most [`MAX_BAND_WORK`] pixel-disparities.
fn band_rows_within(
    BandLimits { bytes: limit, rows: max_rows }: BandLimits,
    texture_limit: u64,
    size: Size,
    config: &DenseConfig,
    tile: Tile,
    unit: u32,
) -> Result<u32> {
    let Size { width, height } = size;
    let work = u64::from(width) * u64::from(config.searched(width)?.count);
    let quick_rows = u32::try_from(MAX_BAND_WORK / work).unwrap_or(u32::MAX);
    let whole_units = |rows: u32| if rows >= height { height } else { (rows / unit * unit).max(unit) };
    let mut rows = whole_units(max_rows.min(quick_rows).clamp(1, height.min(MAX_BAND_ROWS)));
    loop {
        let planes = 4 * in_rows(Layout::new(size, 0, rows, config, tile)?.words());
        let map = MapLayout { width, rows };
        let matches = 4 * map.words();
        // Winners of the other view, in a texture.
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
