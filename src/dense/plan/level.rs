//! Semi-global matching of a level of a pyramid, where each cell has a range of its own: the plan.
//!
//! costs -> one path per direction -> selection -> claims and the left-right consistency they allow -> filters. Volumes
//! hold what the cells need, in bands of rows as in [`super::costs`]; the result does not depend on where bands are cut.

use std::ops::Range;

use super::{
    BandLimits, Plan, WholeMap,
    refine::{After, StoredMap, Unrefined, plan_after_bands},
    transform::Transform,
};
use crate::{
    dense::{
        config::{Aggregation, Cost, DenseConfig, Direction, Filters, View},
        kernels::{
            CellCost, CellLayout, CellPath, CellSelect, CheckedAgainst, Claim, Consistency, LevelBand, LineBuffers,
            MapBuffer, MapLayout, PathVolumes, ResultKind, Selection, pixels_per_thread, row_words,
        },
        pyramid::CellTable,
        uploaded::UploadedPair,
        word_copy::{CopyTarget, WordCopy},
    },
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu},
    image::Size,
};

/// Rows of a band are a multiple of these where a band can have so many: software drivers follow as many lines at once.
const LINES: usize = 8;

/// The kernels of all levels of a pyramid: their code depends on no size and no range.
pub(in crate::dense) struct LevelKernels {
    /// What a match costs, for the transforms that it needs.
    matching: Cost,
    cost: CellCost,
    path: CellPath,
    select: CellSelect,
    claim: Claim,
    /// Whether the winners' keys are written too, for claims.
    keys: bool,
    directions: &'static [Direction],
}

/// A pair to be matched on a level.
#[derive(Clone, Copy)]
pub(in crate::dense) struct LevelTask<'a> {
    /// Configuration, with the whole range of the level.
    pub(in crate::dense) config: &'a DenseConfig,
    /// Disparities of the cells.
    pub(in crate::dense) table: &'a CellTable,
    /// Filters of the map, if any.
    pub(in crate::dense) filters: Option<&'a Filters>,
    /// The pair in the size of the level, with the colours of the reference view if the filters fill holes.
    pub(in crate::dense) pair: &'a UploadedPair,
}

impl LevelTask<'_> {
    /// What is done to the map of all bands.
    fn after(&self) -> After {
        After { filters: self.filters.cloned(), ..After::of(&self.config.parameters) }
    }

    /// Whether the map of all bands is worked on.
    pub(in crate::dense) fn goes_on(&self) -> bool {
        let after = self.after();
        after.filters.is_some() || after.agreement.is_some() || self.pair.masks.is_some()
    }

    /// Plans what follows the matching, in windows of rows within `limits`: a plan of its own, so that the volumes of the
    /// matching are free before. `map` is what the plan of the matching has collected.
    pub(in crate::dense) fn plan_refinement(&self, gpu: &Gpu, map: WholeMap, limits: BandLimits) -> Result<Plan> {
        let &LevelTask { config, table, pair, .. } = self;
        let mut plan = Plan::new(gpu, config, 1);
        let (size, range, map) = (table.size, table.range, StoredMap::Whole(map));
        let unrefined = Unrefined { map, size, range, pair, reference: config.reference };
        plan_after_bands(gpu, &mut plan, &self.after(), unrefined, limits)?;
        Ok(plan)
    }
}

impl LevelKernels {
    /// Compiles the kernels for `config`, which has costs and at least one path.
    pub(in crate::dense) fn new(gpu: &Gpu, config: &DenseConfig) -> Self {
        let Aggregation::Costs(costs) = &config.parameters.aggregation else {
            unreachable!("a pyramid of blocks");
        };
        let directions = costs.semi_global.map_or(&[][..], |semi_global| semi_global.paths.directions());
        let selection = Selection {
            stored: directions.len() as u32,
            interpolation: config.parameters.interpolation,
            kind: ResultKind::Matches,
            keys: config.parameters.consistency.is_some(),
            uniqueness: config.parameters.uniqueness,
        };
        Self {
            matching: costs.cost,
            cost: CellCost::new(gpu, &costs.cost, config.reference, pixels_per_thread(gpu)),
            path: CellPath::new(gpu, &costs.followed_with()),
            select: CellSelect::new(gpu, selection),
            claim: Claim::new(gpu),
            keys: selection.keys,
            directions,
        }
    }

    /// Plans the matching of a level in bands within `limits`, with a checkpoint after each. The map is collected if it is
    /// to be refined.
    pub(in crate::dense) fn plan(&self, gpu: &Gpu, task: LevelTask<'_>, limits: BandLimits) -> Result<Plan> {
        let LevelTask { config, table, .. } = task;
        let (size, range) = (table.size, table.range);
        let volumes = Volumes::new(table, self.directions.len() as u64, limits)?;
        let mut plan = Plan::new(gpu, config, volumes.bands.len());
        if task.goes_on() {
            plan.keep_whole(size)?;
        }
        let level = self.level(gpu, &mut plan, task, volumes)?;
        let check = match config.parameters.consistency {
            None => None,
            Some(max_difference) => {
                let claims = plan.buffer("claims", level.map.pixels().into())?;
                let check = Consistency::new(gpu, CheckedAgainst::Claims(range.min));
                Some((max_difference, check, claims))
            }
        };
        level.plan_paths_from_below(&mut plan);
        for index in 0..level.volumes.bands.len() {
            level.match_band(&mut plan, index);
            let (band, matches) = (level.band(index), MapBuffer { buffer: &level.matches, layout: level.map });
            if let Some((max_difference, consistency, claims)) = &check {
                plan.clear(claims);
                plan.run(self.claim.prepare_rows(band.rows, range.min, config.reference, matches, claims));
                plan.run(consistency.prepare(matches, band.rows, config.reference, *max_difference, claims));
            }
            plan.hand_out(matches, band.top, band.rows);
            plan.checkpoint();
        }
        Ok(plan)
    }

    /// Allocates the memory of a level.
    fn level<'a>(
        &'a self,
        gpu: &Gpu,
        plan: &mut Plan,
        LevelTask { config, table, pair, .. }: LevelTask<'a>,
        volumes: Volumes,
    ) -> Result<LevelPlan<'a>> {
        let size = table.size;
        let most_rows = volumes.bands.iter().map(|band| band.len() as u32).max().unwrap_or(1);
        let map = MapLayout { width: size.width, rows: most_rows };
        let key_words = if self.keys { map.pixels() } else { 0 };
        let (bands, row, with) = (volumes.bands.len() as u64, volumes.most_row, |dy| self.with(dy).count() as u64);
        Ok(LevelPlan {
            transform: Transform::new(gpu, plan, &self.matching, (size, most_rows + 2), pair.luma.each_ref())?,
            layout: CellLayout::new(gpu, table, &volumes.bands)?,
            costs: plan.buffer("costs", volumes.most_band)?,
            paths: plan.buffer("paths", volumes.words() * self.directions.len() as u64)?,
            above: plan.buffer("paths from above", row * with(1))?,
            below: (1..bands).map(|_| plan.buffer("paths from below", row * with(-1))).collect::<Result<_>>()?,
            matches: plan.buffer("matches", map.words() + u64::from(key_words))?,
            map,
            kernels: self,
            view: config.reference,
            table,
            volumes,
        })
    }

    /// The paths with vertical step `dy`: index among all, and among those of that step.
    fn with(&self, dy: i32) -> impl Iterator<Item = (usize, u64)> + use<> {
        let directions = self.directions;
        (0..directions.len()).filter(move |&path| directions[path].dy == dy).zip(0..)
    }
}

/// The bands of a level, and the largest volumes of a path.
struct Volumes {
    bands: Vec<Range<u32>>,
    row_words: Vec<u32>,
    /// Words of the largest row, and of the largest band.
    most_row: u64,
    most_band: u64,
}

impl Volumes {
    /// Cuts a level into bands such that `paths` volumes fit in a buffer.
    fn new(table: &CellTable, paths: u64, limits: BandLimits) -> Result<Self> {
        let Size { width, height } = table.size;
        let row_words = row_words(table);
        let most_row = row_words.iter().copied().max().map_or(0, u64::from);
        let limit = (limits.bytes / 4 / paths).saturating_sub(2 * most_row);
        if limit < most_row {
            return Err(Error::TooLarge {
                what: format!("one row of a picture {width} px wide with {} disparities", table.range.count),
                needed: 12 * most_row * paths,
                limit: limits.bytes,
                way_out: format!(
                    "search fewer disparities, scale the pictures down, or use a device with more of {BUFFER_LIMITS}"
                ),
            });
        }
        // The map and its keys, and the census transforms, must fit as well.
        let map_rows = limits.bytes / 4 / (MapLayout { width, rows: 1 }.words() + u64::from(width));
        let most_rows = limits.rows.min(u32::try_from(map_rows).unwrap_or(u32::MAX).saturating_sub(2)).max(1) as usize;
        let mut bands = Vec::new();
        let (mut first, mut most_band) = (0, 0);
        while first < height as usize {
            let mut words = 0;
            let fits = |row: &&u32| {
                words += u64::from(**row);
                words <= limit
            };
            let fitting = row_words[first..].iter().take(most_rows).take_while(fits).count();
            let is_last = first + fitting == height as usize;
            let rows = if is_last || fitting < LINES { fitting } else { fitting / LINES * LINES };
            let band = first..first + rows;
            most_band = most_band.max(row_words[band.clone()].iter().map(|&words| u64::from(words)).sum());
            bands.push(band.start as u32..band.end as u32);
            first = band.end;
        }
        Ok(Self { bands, row_words, most_row, most_band })
    }

    /// Words of the volume of a path: a band, and a halo row on either side.
    fn words(&self) -> u64 {
        self.most_band + 2 * self.most_row
    }

    /// Words of rows of the level.
    fn words_of(&self, rows: Range<u32>) -> u64 {
        self.row_words[rows.start as usize..rows.end as usize].iter().map(|&words| u64::from(words)).sum()
    }
}

/// Kernels and memory of a level.
struct LevelPlan<'a> {
    kernels: &'a LevelKernels,
    view: View,
    table: &'a CellTable,
    volumes: Volumes,
    layout: CellLayout,
    transform: Transform,
    costs: wgpu::Buffer,
    /// The volumes of the paths, one after the other.
    paths: wgpu::Buffer,
    /// The last rows so far of the paths from above.
    above: wgpu::Buffer,
    /// For each band but the first, the first rows of the paths from below.
    below: Vec<wgpu::Buffer>,
    matches: wgpu::Buffer,
    map: MapLayout,
}

impl LevelPlan<'_> {
    fn band(&self, index: usize) -> LevelBand<'_> {
        let rows = &self.volumes.bands[index];
        let width = self.table.size.width;
        LevelBand { layout: &self.layout, width, top: rows.start, first_row: 1, rows: rows.len() as u32 }
    }

    /// Plans the matching costs of band `index`.
    fn plan_costs(&self, plan: &mut Plan, index: usize) {
        let band = self.band(index);
        self.transform.plan(plan, band.top.cast_signed() - 1, band.rows + 2);
        let views = self.transform.of(self.view);
        plan.run(self.kernels.cost.prepare(&band, self.table.range.min, views, &self.costs));
    }

    /// Plans a path through band `index`, continued from row number `place` of `entered_from`, if there is one.
    fn plan_path(&self, plan: &mut Plan, index: usize, path: usize, entered_from: Option<(&wgpu::Buffer, u64)>) {
        let (volumes, rows) = (&self.volumes, &self.volumes.bands[index]);
        let direction = self.kernels.directions[path];
        let start = path as u64 * volumes.words() + volumes.most_row;
        let halo = entered_from.map(|(from, place)| {
            let (row, halo) = match direction.dy {
                1 => (rows.start - 1, start - volumes.most_row),
                _ => (rows.end, start + volumes.words_of(rows.clone())),
            };
            plan.copy(WordCopy {
                from: from.clone(),
                from_word: place * volumes.most_row,
                to: CopyTarget::Buffer(self.paths.clone()),
                to_word: halo,
                words: volumes.words_of(row..row + 1),
            });
            halo as u32
        });
        let [reference, _] = self.transform.of(self.view);
        let lines = LineBuffers { reference, costs: &self.costs, paths: &self.paths };
        for part in self.kernels.path.prepare(&self.band(index), direction, lines, start as u32, halo) {
            plan.run(part);
        }
    }

    /// Keeps row `row` of a path through band `index` as row number `place` of `to`.
    fn keep_row(&self, plan: &mut Plan, index: usize, path: usize, row: u32, (to, place): (&wgpu::Buffer, u64)) {
        let volumes = &self.volumes;
        let first = volumes.bands[index].start;
        plan.copy(WordCopy {
            from: self.paths.clone(),
            from_word: path as u64 * volumes.words() + volumes.most_row + volumes.words_of(first..row),
            to: CopyTarget::Buffer(to.clone()),
            to_word: place * volumes.most_row,
            words: volumes.words_of(row..row + 1),
        });
    }

    /// Plans the paths from below through all bands, and keeps the row that each band hands to the band above.
    fn plan_paths_from_below(&self, plan: &mut Plan) {
        if self.kernels.with(-1).count() == 0 {
            return;
        }
        for index in (1..self.volumes.bands.len()).rev() {
            self.plan_costs(plan, index);
            for (path, place) in self.kernels.with(-1) {
                self.plan_path(plan, index, path, self.below.get(index).map(|rows| (rows, place)));
                self.keep_row(plan, index, path, self.volumes.bands[index].start, (&self.below[index - 1], place));
            }
            plan.checkpoint();
        }
    }

    /// Plans costs, paths and selection of band `index`.
    fn match_band(&self, plan: &mut Plan, index: usize) {
        let rows = &self.volumes.bands[index];
        self.plan_costs(plan, index);
        for (path, place) in self.kernels.with(-1) {
            self.plan_path(plan, index, path, self.below.get(index).map(|rows| (rows, place)));
        }
        for (path, place) in self.kernels.with(1) {
            self.plan_path(plan, index, path, (index > 0).then_some((&self.above, place)));
            self.keep_row(plan, index, path, rows.end - 1, (&self.above, place));
        }
        for (path, _) in self.kernels.with(0) {
            self.plan_path(plan, index, path, None);
        }
        let volumes = PathVolumes { start: self.volumes.most_row as u32, volume_words: self.volumes.words() as u32 };
        let matches = MapBuffer { buffer: &self.matches, layout: self.map };
        plan.run(self.kernels.select.prepare(&self.band(index), self.table.range, &self.paths, volumes, matches));
    }
}
