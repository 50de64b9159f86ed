//! Semi-global matching: the plan.
//!
//! For each view in turn: cost -> its mean over a window, if wanted -> a path in each direction -> selection, then the
//! consistency of both.
//! Where the volumes do not fit in a buffer, the pair is matched in bands of rows, from the top to the
//! bottom, with each path going on from band to band. Paths from below need to be known before: they
//! are followed once from the bottom to the top, of which only the row below each band is kept, and
//! then again within each band. The costs of as many more rows around a band as its windows reach are computed with
//! it. So no result depends on where the bands are cut.

use super::{BandLimits, CopyTarget, Plan, WordCopy, match_words, refine::plan_refinement};
use crate::{
    dense::{
        config::{DenseConfig, Direction, OtherView, SemiGlobal, View},
        kernels::{
            BoxMean, Census, Claim, Consistency, CostVolume, Others, Pad, Path, Places, Select, Selection, Views,
            VolumeBand, Wanted,
        },
    },
    disparity::DisparityRange,
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu},
};

/// What both views share: the pictures, memory for the transforms and volumes of a band, and kernels.
struct Shared {
    size: (u32, u32),
    band_rows: u32,
    /// How many rows around a band its windows reach.
    radius: u32,
    /// The left and the right picture, each with how its brightness is changed.
    pictures: [(wgpu::Buffer, wgpu::Buffer); 2],
    pad: Pad,
    transform: Census,
    padded: wgpu::Buffer,
    census: [wgpu::Buffer; 2],
    /// Those of a band and of the rows around it; when they are averaged, those of the band alone.
    costs: wgpu::Buffer,
    /// What averages them, and as much memory again.
    box_mean: Option<(BoxMean, wgpu::Buffer)>,
    /// A volume for each path that is stored, each with a row in front of it and one behind.
    paths: wgpu::Buffer,
    path_words: u64,
    /// None where nothing is stored.
    path: Option<Path>,
}

/// One view's kernels, and what it keeps from one band to the next.
struct Side {
    view: View,
    cost: CostVolume,
    last: Direction,
    /// The directions of the paths that are stored.
    directions: &'static [Direction],
    select: Select,
    /// The last rows so far of the paths from above; and for each band but the first, the first rows of the
    /// paths from below. None where there is one band.
    above: Option<wgpu::Buffer>,
    below: Vec<wgpu::Buffer>,
    /// In which buffer its answers stand.
    matches: wgpu::Buffer,
}

/// The plan for packed `left` and `right` of `size`, in bands within `limits`.
pub(in crate::dense) fn plan(
    gpu: &Gpu,
    size: (u32, u32),
    config: &DenseConfig,
    semi_global: &SemiGlobal,
    views: [&wgpu::Buffer; 2],
    limits: BandLimits,
) -> Result<Plan> {
    let (width, height) = size;
    let range = config.searched(width)?;
    let (last, directions) = semi_global.paths.last_and_stored();
    let radius = semi_global.radius();
    let band_rows = band_rows_within(limits, size, range, (directions.len() as u64, radius))?;
    // The transforms of a band have those rows more in front of it that windows reach, and one where lines come from; and
    // as many behind.
    let around = radius + 1;
    let rows = |first_row: u32| band_rows.min(height - first_row);
    let band = |first_row: u32| VolumeBand { width, first_row: around, rows: rows(first_row), range };
    let bands: Vec<VolumeBand> = (0..height).step_by(band_rows as usize).map(band).collect();
    let row_words = u64::from(bands[0].row_words());

    let mut plan = Plan::new(gpu, config, bands.len());
    let whole = config.refinement.map(|_| plan.collect(size)).transpose()?;
    let path_words = row_words * (u64::from(band_rows) + 2);
    let cost_words = row_words * u64::from((band_rows + 2 * radius).min(height));
    let padding = Census::padding(size, 0, band_rows + 2 * around);
    let transformed = u64::from(width) * u64::from(band_rows + 2 * around);
    let penalties = semi_global.followed_with();
    let box_mean = match semi_global.window {
        1 => None,
        side => Some((BoxMean::new(gpu, side), plan.buffer("means of costs", cost_words)?)),
    };
    let shared = Shared {
        size,
        band_rows,
        radius,
        pictures: [(views[0].clone(), plan.brightness(View::Left)), (views[1].clone(), plan.brightness(View::Right))],
        pad: Pad::new(gpu),
        transform: Census::new(gpu),
        padded: plan.buffer("padded rows", u64::from(padding.rows) * u64::from(padding.stride))?,
        census: [plan.buffer("census, left", transformed)?, plan.buffer("census, right", transformed)?],
        costs: plan.buffer("costs", cost_words)?,
        box_mean,
        paths: plan.buffer("paths", path_words * directions.len() as u64)?,
        path_words,
        path: (!directions.is_empty()).then(|| Path::new(gpu, &penalties, bands[0].words())),
    };
    let (match_words, confidence_offset) = match_words(width, band_rows);
    let claimed = config.consistency.is_some() && semi_global.other_view == OtherView::Claimed;
    let key_words = if claimed { u64::from(confidence_offset) } else { 0 };
    let offsets = [confidence_offset, match_words as u32];
    let mut side = |view: View, wanted: Wanted| -> Result<Side> {
        let mut rows = |label, dy| {
            let paths = directions.iter().filter(|direction| direction.dy == dy).count();
            plan.buffer(label, row_words * paths as u64)
        };
        let above = (bands.len() > 1).then(|| rows("paths from above", 1)).transpose()?;
        let below = (1..bands.len()).map(|_| rows("paths from below", -1)).collect::<Result<_>>()?;
        let matches = match wanted {
            Wanted::Matches => plan.buffer("matches", match_words + key_words)?,
            Wanted::Winners => plan.buffer("winners of the other view", confidence_offset.into())?,
        };
        let selection = Selection {
            stored: directions.len() as u32,
            interpolation: config.interpolation,
            wanted,
            keys: claimed,
            uniqueness: config.uniqueness,
        };
        Ok(Side {
            view,
            cost: CostVolume::new(gpu, &semi_global.cost, view),
            directions,
            select: Select::new(gpu, &penalties, bands[0].words(), selection),
            last,
            above,
            below,
            matches,
        })
    };
    let mut sides = vec![side(config.reference, Wanted::Matches)?];
    if config.consistency.is_some() && !claimed {
        sides.push(side(config.reference.other(), Wanted::Winners)?);
    }

    if directions.iter().any(|direction| direction.dy < 0) {
        for index in (1..bands.len()).rev() {
            shared.transform(&mut plan, index);
            for side in &sides {
                side.follow_from_below(&mut plan, &shared, &bands, index);
            }
        }
    }
    let others = if claimed { Others::Claims(range.min) } else { Others::Disparities };
    let check = config.consistency.map(|limit| (Consistency::new(gpu, others), limit));
    let claims = match claimed {
        true => Some((Claim::new(gpu), plan.buffer("claims", confidence_offset.into())?)),
        false => None,
    };
    for (index, band) in bands.iter().enumerate() {
        shared.transform(&mut plan, index);
        for side in &sides {
            side.match_band(&mut plan, &shared, &bands, index, offsets);
        }
        let (matches, view) = (&sides[0].matches, config.reference);
        if let Some((claim, claims)) = &claims {
            plan.clear(claims);
            plan.run(claim.prepare(band, view, offsets[1], matches, claims));
        }
        let others = claims.as_ref().map(|(_, claims)| claims).or(sides.get(1).map(|other| &other.matches));
        if let (Some((consistency, limit)), Some(others)) = (&check, others) {
            let size = (width, band.rows);
            plan.run(consistency.prepare(size, confidence_offset, view, *limit, others, matches));
        }
        plan.hand_out(matches, confidence_offset, width, (index as u32 * band_rows, band.rows));
    }
    if let (Some(whole), Some(refinement)) = (whole, &config.refinement) {
        let views = Views { luma: views, brightness: &plan.brightness(View::Right), reference: config.reference };
        plan_refinement(gpu, &mut plan, size, refinement, range, views, &whole, limits)?;
    }
    Ok(plan)
}

impl Shared {
    /// Transforms the rows of band `index` of both views, with those around them.
    fn transform(&self, plan: &mut Plan, index: usize) {
        let first_row = index as u32 * self.band_rows;
        let around = self.radius + 1;
        let rows = self.band_rows.min(self.size.1 - first_row) + 2 * around;
        for ((picture, brightness), census) in self.pictures.iter().zip(&self.census) {
            let padding = Census::padding(self.size, first_row.cast_signed() - around.cast_signed(), rows);
            plan.run(self.pad.prepare(padding, brightness, picture, &self.padded));
            plan.run(self.transform.prepare((self.size.0, rows), &self.padded, census));
        }
    }
}

impl Side {
    /// The transforms of this view and of the other.
    fn census<'m>(&self, shared: &'m Shared) -> [&'m wgpu::Buffer; 2] {
        let [left, right] = &shared.census;
        match self.view {
            View::Left => [left, right],
            View::Right => [right, left],
        }
    }

    /// Compares the pixels of band `index`, and averages over their windows.
    fn find_costs(&self, plan: &mut Plan, shared: &Shared, bands: &[VolumeBand], index: usize) {
        let band = &bands[index];
        let first_row = index as u32 * shared.band_rows;
        let above = shared.radius.min(first_row);
        let below = shared.radius.min(shared.size.1 - first_row - band.rows);
        let known = VolumeBand { first_row: band.first_row - above, rows: above + band.rows + below, ..*band };
        plan.run(self.cost.prepare(&known, self.census(shared), &shared.costs));
        if let Some((box_mean, means)) = &shared.box_mean {
            let wanted = above..above + band.rows;
            for pass in box_mean.prepare(&known, wanted, &shared.costs, means) {
                plan.run(pass);
            }
        }
    }

    /// The stored paths with this step from row to row: their number, and their place among themselves.
    fn paths(&self, dy: i32) -> impl Iterator<Item = (usize, u64)> {
        let numbers = (0..self.directions.len()).filter(move |&number| self.directions[number].dy == dy);
        numbers.zip(0..)
    }

    /// Follows the paths from below through a band, and keeps their first row for the band above.
    fn follow_from_below(&self, plan: &mut Plan, shared: &Shared, bands: &[VolumeBand], index: usize) {
        let band = &bands[index];
        self.find_costs(plan, shared, bands, index);
        for (number, place) in self.paths(-1) {
            self.follow(plan, shared, band, number, self.below.get(index).map(|rows| (rows, place)));
            let row = u64::from(band.row_words());
            plan.copy(WordCopy {
                from: shared.paths.clone(),
                from_word: number as u64 * shared.path_words + row,
                to: CopyTarget::Buffer(self.below[index - 1].clone()),
                to_word: place * row,
                words: row,
            });
        }
    }

    /// Copies the row that a path enters a band from to its place in front of the band, or behind it.
    fn enter(
        &self,
        plan: &mut Plan,
        shared: &Shared,
        band: &VolumeBand,
        number: usize,
        (rows, place): (&wgpu::Buffer, u64),
    ) {
        let row = u64::from(band.row_words());
        let before = if self.directions[number].dy > 0 { 0 } else { u64::from(band.rows) + 1 };
        plan.copy(WordCopy {
            from: rows.clone(),
            from_word: place * row,
            to: CopyTarget::Buffer(shared.paths.clone()),
            to_word: number as u64 * shared.path_words + before * row,
            words: row,
        });
    }

    /// Follows a path through a band, from where it enters it if it does not begin there.
    fn follow(
        &self,
        plan: &mut Plan,
        shared: &Shared,
        band: &VolumeBand,
        number: usize,
        from: Option<(&wgpu::Buffer, u64)>,
    ) {
        let row = u64::from(band.row_words());
        let direction = self.directions[number];
        let start = number as u64 * shared.path_words;
        if let Some(from) = from {
            self.enter(plan, shared, band, number, from);
        }
        let [reference, _] = self.census(shared);
        let (costs, paths, start) = (&shared.costs, &shared.paths, (start + row) as u32);
        // There is one, as there is a path to follow.
        if let Some(path) = &shared.path {
            plan.run(path.prepare(band, direction, reference, costs, paths, start, from.is_some()));
        }
    }

    /// Costs, paths and answers of a band.
    fn match_band(&self, plan: &mut Plan, shared: &Shared, bands: &[VolumeBand], index: usize, offsets: [u32; 2]) {
        let band = &bands[index];
        let row = u64::from(band.row_words());
        self.find_costs(plan, shared, bands, index);
        for (number, place) in self.paths(-1) {
            self.follow(plan, shared, band, number, self.below.get(index).map(|rows| (rows, place)));
        }
        for (number, place) in self.paths(1) {
            let above = self.above.as_ref().filter(|_| index > 0).map(|rows| (rows, place));
            self.follow(plan, shared, band, number, above);
            if let Some(above) = &self.above {
                plan.copy(WordCopy {
                    from: shared.paths.clone(),
                    from_word: number as u64 * shared.path_words + row * u64::from(band.rows),
                    to: CopyTarget::Buffer(above.clone()),
                    to_word: place * row,
                    words: row,
                });
            }
        }
        for (number, _) in self.paths(0) {
            self.follow(plan, shared, band, number, None);
        }
        self.select(plan, shared, band, offsets);
    }

    /// Follows the last path through a band, and selects.
    fn select(&self, plan: &mut Plan, shared: &Shared, band: &VolumeBand, [confidence_offset, key_offset]: [u32; 2]) {
        let volume_words = shared.path_words as u32;
        let places = Places { start: band.row_words(), volume_words, confidence_offset, key_offset };
        let [reference, _] = self.census(shared);
        let (direction, costs, paths, matches) = (self.last, &shared.costs, &shared.paths, &self.matches);
        plan.clear(matches);
        let select = &self.select;
        plan.run(select.prepare(band, direction, places, reference, costs, paths, matches));
    }
}

/// The most rows for which the volumes of a band stay within `limits`: the costs, with `radius` more
/// rows on either side, and so many stored `paths`.
fn band_rows_within(
    limits: BandLimits,
    (width, height): (u32, u32),
    range: DisparityRange,
    (paths, radius): (u64, u32),
) -> Result<u32> {
    let limit = limits.bytes;
    let row = 4 * u64::from(width) * u64::from(range.count.div_ceil(4));
    // The transforms, a word a pixel, are at most as large as costs of as many rows.
    let around = 2 * (u64::from(radius) + 1);
    let needed = row * (3 * paths).max(1 + around);
    // A row's answers with their keys can be more than its volumes, where there are few disparities.
    let answers = 4 * (match_words(width, 1).0 + u64::from(width));
    let within_paths = (limit / (row * paths.max(1))).saturating_sub(2);
    let within_costs = (limit / row).saturating_sub(around);
    let rows = within_paths.min(within_costs).min(limit / answers);
    if rows == 0 {
        return Err(Error::TooLarge {
            what: format!("one row of a picture {width} px wide with {} disparities", range.count),
            needed,
            limit,
            way_out: format!(
                "search fewer disparities, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"
            ),
        });
    }
    Ok(u32::try_from(rows).unwrap_or(u32::MAX).min(limits.rows).min(height).max(1))
}
