//! Matching by costs of census, luma and gradient, semi-globally along paths or by blocks: the plan.
//!
//! Per view: costs -> optional mean over a window -> one path per direction -> selection; then the left-right
//! consistency of both views.
//!
//! Volumes that exceed the buffer limits are processed in bands of rows, from top to bottom, and each path continues
//! from band to band. Paths from below must be known beforehand: they are followed once from bottom to top, keeping
//! only the row below each band, and then again within each band. The costs of a band are computed with a halo of as
//! many rows as the averaging window reaches. The result does not depend on where bands are cut.

use super::{
    BandLimits, Plan,
    followers::{CostKernel, Following, PathKernel, SelectKernel},
    refine::{After, StoredMap, Unrefined, plan_after_bands},
    transform::Transform,
};
use crate::{
    dense::{
        config::{CostAggregation, CrossCheck, DenseConfig, Direction, View},
        kernels::{
            BoxMean, CheckedAgainst, Claim, Consistency, FollowedPath, LineBuffers, MapBuffer, MapLayout, PathVolumes,
            ResultKind, Selection, VolumeBand,
        },
        uploaded::UploadedPair,
        word_copy::{CopyTarget, WordCopy},
    },
    disparity::DisparityRange,
    error::{Error, Result},
    gpu::{BUFFER_LIMITS, Gpu, check_turns},
    image::Size,
};

/// Plans the matching of a `pair` of `size` in bands within `limits`; holes are filled by the colours
/// of the reference view.
pub(in crate::dense) fn plan(
    gpu: &Gpu,
    size: Size,
    config: &DenseConfig,
    costs: &CostAggregation,
    pair: &UploadedPair,
    limits: BandLimits,
) -> Result<Plan> {
    check_turns(gpu, size)?;
    let width = size.width;
    let range = config.searched(width)?;
    let bands = Bands::new(gpu, size, range, costs, limits)?;
    let mut plan = Plan::new(gpu, config, bands.count());
    let goes_on = config.parameters.goes_on() || pair.masks.is_some();
    if goes_on {
        plan.keep(size)?;
    }
    let workspace = Workspace::new(gpu, &mut plan, bands, costs, pair.luma.each_ref())?;
    let layout = MapLayout { width, rows: workspace.bands.rows };
    let is_claimed = config.parameters.consistency.is_some() && costs.cross_check == CrossCheck::Claimed;
    let side = |plan: &mut Plan, view, kind, keys| {
        let selection = Selection {
            stored: workspace.bands.directions.len() as u32,
            interpolation: config.parameters.interpolation,
            kind,
            keys,
            uniqueness: config.parameters.uniqueness,
        };
        Side::new(gpu, plan, &workspace.bands, costs, view, selection)
    };
    let reference = side(&mut plan, config.reference, ResultKind::Matches, is_claimed)?;
    let check = match config.parameters.consistency {
        None => None,
        Some(max_difference) if is_claimed => {
            let claims = plan.buffer("claims", layout.pixels().into())?;
            let check = Consistency::new(gpu, CheckedAgainst::Claims(range.min));
            Some((max_difference, check, OtherSource::Claimed(Claim::new(gpu), claims)))
        }
        Some(max_difference) => {
            let other = side(&mut plan, config.reference.other(), ResultKind::Winners, false)?;
            let check = Consistency::new(gpu, CheckedAgainst::Disparities);
            Some((max_difference, check, OtherSource::Searched(other)))
        }
    };
    let searched = match &check {
        Some((_, _, OtherSource::Searched(other))) => Some(other),
        _ => None,
    };

    if workspace.bands.directions.iter().any(|direction| direction.dy < 0) {
        for index in (1..workspace.bands.count()).rev() {
            workspace.transform(&mut plan, index);
            for side in [Some(&reference), searched].into_iter().flatten() {
                side.plan_paths_from_below(&mut plan, &workspace, index);
            }
        }
    }
    for index in 0..workspace.bands.count() {
        let band = workspace.bands.band(index);
        workspace.transform(&mut plan, index);
        for side in [Some(&reference), searched].into_iter().flatten() {
            side.match_band(&mut plan, &workspace, index);
        }
        let matches = MapBuffer { buffer: &reference.matches, layout };
        if let Some((max_difference, consistency, source)) = &check {
            let other_disparities = match source {
                OtherSource::Searched(other) => &other.matches,
                OtherSource::Claimed(claim, claims) => {
                    plan.clear(claims);
                    plan.run(claim.prepare(&band, config.reference, matches, claims));
                    claims
                }
            };
            plan.run(consistency.prepare(matches, band.rows, config.reference, *max_difference, other_disparities));
        }
        plan.hand_out(matches, workspace.bands.first_row(index), band.rows);
        plan.checkpoint();
    }
    if goes_on {
        let map = &reference.matches;
        let after = After::of(&config.parameters);
        let unrefined = Unrefined { map: StoredMap::of(&plan, map), size, range, pair, reference: config.reference };
        plan_after_bands(gpu, &mut plan, &after, unrefined, limits)?;
    }
    Ok(plan)
}

/// The source of the other view's disparities for the left-right consistency check.
enum OtherSource {
    /// A second search, with the other view as the reference.
    Searched(Side),
    /// Claims of the reference view's winners.
    Claimed(Claim, wgpu::Buffer),
}

/// The bands of rows of a pair.
struct Bands {
    size: Size,
    range: DisparityRange,
    /// Rows of a band; the last band can have fewer.
    rows: u32,
    /// Halo rows of costs on either side of a band: the radius of the averaging window.
    radius: u32,
    /// By which kernels paths are followed.
    following: Following,
    /// Directions of the stored paths.
    directions: &'static [Direction],
}

impl Bands {
    fn new(gpu: &Gpu, size: Size, range: DisparityRange, costs: &CostAggregation, limits: BandLimits) -> Result<Self> {
        let (following, directions) = Following::new(gpu, costs, range);
        let radius = costs.radius();
        let rows = band_rows_within(limits, size, range, (directions.len() as u64, radius))?;
        Ok(Self { size, range, rows, radius, following, directions })
    }

    fn count(&self) -> usize {
        self.size.height.div_ceil(self.rows) as usize
    }

    fn first_row(&self, index: usize) -> u32 {
        index as u32 * self.rows
    }

    /// Halo rows of the census transforms on either side of a band: the radius of the averaging window, and one row
    /// from which paths enter.
    fn halo(&self) -> u32 {
        self.radius + 1
    }

    /// The cost volume of band `index`, without halo.
    fn band(&self, index: usize) -> VolumeBand {
        let rows = self.rows.min(self.size.height - self.first_row(index));
        VolumeBand { width: self.size.width, first_row: self.halo(), rows, range: self.range }
    }

    /// Words per row of a volume.
    fn row_words(&self) -> u64 {
        self.band(0).row_words().into()
    }

    /// Words of the volume of a stored path: a band and one halo row on either side.
    fn path_words(&self) -> u64 {
        self.row_words() * (u64::from(self.rows) + 2)
    }
}

/// Pictures, kernels, and the memory for census transforms and volumes of a band, shared by both views.
struct Workspace {
    bands: Bands,
    transform: Transform,
    /// Matching costs of the band and its halo rows; after averaging, of the band only.
    costs: wgpu::Buffer,
    /// The averaging kernel, and memory for costs averaged along rows only.
    box_mean: Option<(BoxMean, wgpu::Buffer)>,
    /// The volumes of the stored paths, one after the other.
    paths: wgpu::Buffer,
    path: PathKernel,
}

impl Workspace {
    fn new(
        gpu: &Gpu,
        plan: &mut Plan,
        bands: Bands,
        costs: &CostAggregation,
        luma: [&wgpu::Buffer; 2],
    ) -> Result<Self> {
        let height = bands.size.height;
        let cost_words = bands.row_words() * u64::from((bands.rows + 2 * bands.radius).min(height));
        let transformed_rows = bands.rows + 2 * bands.halo();
        let box_mean = match costs.window {
            1 => None,
            side => Some((BoxMean::new(gpu, side), plan.buffer("means of costs", cost_words)?)),
        };
        let penalties = costs.followed_with();
        Ok(Self {
            transform: Transform::new(gpu, plan, &costs.cost, (bands.size, transformed_rows), luma)?,
            costs: plan.buffer("costs", cost_words)?,
            box_mean,
            // At least the four words that kernels load at once, where no path is stored.
            paths: plan.buffer("paths", (bands.path_words() * bands.directions.len() as u64).max(4))?,
            path: PathKernel::new(gpu, bands.following, &penalties, bands.band(0).words(), bands.directions.len()),
            bands,
        })
    }

    /// Plans the census transforms of band `index` and its halo, for both views.
    fn transform(&self, plan: &mut Plan, index: usize) {
        let halo = self.bands.halo();
        let first_row = self.bands.first_row(index).cast_signed() - halo.cast_signed();
        self.transform.plan(plan, first_row, self.bands.band(index).rows + 2 * halo);
    }

    /// The volumes of the stored paths from number `path` on.
    fn volumes(&self, path: usize) -> PathVolumes {
        let (row, words) = (self.bands.row_words(), self.bands.path_words());
        PathVolumes { start: (path as u64 * words + row) as u32, volume_words: words as u32 }
    }

    /// Plans the copy of the row `entered_from`, from which stored path `path` enters band `index`, and returns whether there is
    /// one; without it the path begins in the band.
    fn enter(&self, plan: &mut Plan, index: usize, path: usize, entered_from: Option<PathRow<'_>>) -> bool {
        let Some((rows, place)) = entered_from else { return false };
        let (bands, row) = (&self.bands, self.bands.row_words());
        // The halo row above the band, or the one below it.
        let halo_row = if bands.directions[path].dy > 0 { 0 } else { u64::from(bands.band(index).rows) + 1 };
        plan.copy(WordCopy {
            from: rows.clone(),
            from_word: place * row,
            to: CopyTarget::Buffer(self.paths.clone()),
            to_word: path as u64 * bands.path_words() + halo_row * row,
            words: row,
        });
        true
    }

    /// Plans `paths`, stored from number `first` on, through band `index` of a view.
    fn follow(&self, plan: &mut Plan, view: View, index: usize, first: usize, paths: &[FollowedPath]) {
        self.path.plan(plan, &self.bands.band(index), paths, self.lines(view), self.volumes(first));
    }

    /// Keeps row `row` of the volume of stored path `path`, of which row 0 is the halo, as row number `place` of `to`.
    fn keep_row(&self, plan: &mut Plan, path: usize, row: u32, (to, place): PathRow<'_>) {
        let words = self.bands.row_words();
        plan.copy(WordCopy {
            from: self.paths.clone(),
            from_word: path as u64 * self.bands.path_words() + words * u64::from(row),
            to: CopyTarget::Buffer(to.clone()),
            to_word: place * words,
            words,
        });
    }

    /// The buffers of a path of a view.
    fn lines(&self, view: View) -> LineBuffers<'_> {
        let [reference, _] = self.transform.of(view);
        LineBuffers { reference, costs: &self.costs, paths: &self.paths }
    }
}

/// Kernels of one view, and the path rows that it carries from band to band.
struct Side {
    view: View,
    cost: CostKernel,
    select: SelectKernel,
    /// The last rows so far of the paths from above; none where there is one band.
    above: Option<wgpu::Buffer>,
    /// For each band but the first, the first rows of the paths from below.
    below: Vec<wgpu::Buffer>,
    /// The map of the band.
    matches: wgpu::Buffer,
}

/// A row of a path's volume at the edge of a band: a buffer of rows, and the index of the row in it.
type PathRow<'b> = (&'b wgpu::Buffer, u64);

impl Side {
    fn new(
        gpu: &Gpu,
        plan: &mut Plan,
        bands: &Bands,
        costs: &CostAggregation,
        view: View,
        selection: Selection,
    ) -> Result<Self> {
        let mut rows = |label, dy| {
            let paths = bands.directions.iter().filter(|direction| direction.dy == dy).count();
            plan.buffer(label, bands.row_words() * paths as u64)
        };
        let above = (bands.count() > 1).then(|| rows("paths from above", 1)).transpose()?;
        let below = (1..bands.count()).map(|_| rows("paths from below", -1)).collect::<Result<_>>()?;
        let layout = MapLayout { width: bands.size.width, rows: bands.rows };
        let key_words = if selection.keys { u64::from(layout.pixels()) } else { 0 };
        let matches = match selection.kind {
            ResultKind::Matches => plan.buffer("matches", layout.words() + key_words)?,
            ResultKind::Winners => plan.buffer("winners of the other view", layout.pixels().into())?,
        };
        let (cost, penalties) = (CostKernel::new(gpu, bands.following, &costs.cost, view), costs.followed_with());
        let select = SelectKernel::new(gpu, bands.following, &penalties, bands.band(0).words(), selection);
        Ok(Self { view, cost, select, above, below, matches })
    }

    /// Plans the matching costs of band `index`, averaged over their windows.
    fn plan_costs(&self, plan: &mut Plan, workspace: &Workspace, index: usize) {
        let bands = &workspace.bands;
        let (band, first_row) = (bands.band(index), bands.first_row(index));
        let above = bands.radius.min(first_row);
        let below = bands.radius.min(bands.size.height - first_row - band.rows);
        let with_halo = VolumeBand { first_row: band.first_row - above, rows: above + band.rows + below, ..band };
        self.cost.plan(plan, &with_halo, workspace.transform.of(self.view), &workspace.costs);
        if let Some((box_mean, means)) = &workspace.box_mean {
            let band_rows = above..above + band.rows;
            for pass in box_mean.prepare(&with_halo, band_rows, &workspace.costs, means) {
                plan.run(pass);
            }
        }
    }

    /// Plans the paths from below through band `index`, and keeps their first rows for the band above.
    fn plan_paths_from_below(&self, plan: &mut Plan, workspace: &Workspace, index: usize) {
        let bands = &workspace.bands;
        self.plan_costs(plan, workspace, index);
        for (path, place) in paths_with(bands, -1) {
            let goes_on = workspace.enter(plan, index, path, self.below.get(index).map(|rows| (rows, place)));
            workspace.follow(plan, self.view, index, path, &[(bands.directions[path], goes_on)]);
            workspace.keep_row(plan, path, 1, (&self.below[index - 1], place));
        }
    }

    /// Plans costs, paths and selection of band `index`.
    fn match_band(&self, plan: &mut Plan, workspace: &Workspace, index: usize) {
        let bands = &workspace.bands;
        let band = bands.band(index);
        self.plan_costs(plan, workspace, index);
        let mut paths: Vec<_> = bands.directions.iter().map(|&direction| (direction, false)).collect();
        for (path, place) in paths_with(bands, -1) {
            paths[path].1 = workspace.enter(plan, index, path, self.below.get(index).map(|rows| (rows, place)));
        }
        for (path, place) in paths_with(bands, 1) {
            let above = self.above.as_ref().filter(|_| index > 0).map(|rows| (rows, place));
            paths[path].1 = workspace.enter(plan, index, path, above);
        }
        workspace.follow(plan, self.view, index, 0, &paths);
        if let Some(above) = &self.above {
            for (path, place) in paths_with(bands, 1) {
                workspace.keep_row(plan, path, band.rows, (above, place));
            }
        }
        let layout = MapLayout { width: band.width, rows: bands.rows };
        let matches = MapBuffer { buffer: &self.matches, layout };
        plan.clear(&self.matches);
        self.select.plan(plan, &band, workspace.lines(self.view), workspace.volumes(0), matches);
    }
}

/// The stored paths with vertical step `dy`: index among all stored paths, and index among the paths of that step.
fn paths_with(bands: &Bands, dy: i32) -> impl Iterator<Item = (usize, u64)> + use<> {
    let directions = bands.directions;
    (0..directions.len()).filter(move |&path| directions[path].dy == dy).zip(0..)
}

/// The most rows of a band with its volumes within `limits`: costs with `radius` halo rows on either side, and `paths`
/// stored paths.
fn band_rows_within(
    limits: BandLimits,
    Size { width, height }: Size,
    range: DisparityRange,
    (paths, radius): (u64, u32),
) -> Result<u32> {
    let limit = limits.bytes;
    let row = u64::from(width) * u64::from(DisparityRange::padded(range.count));
    // Census transforms, two `u32` per pixel, have a halo one row wider than that of the costs.
    let (around, transformed_row) = (2 * (u64::from(radius) + 1), row.max(8 * u64::from(width)));
    let needed = (row * 3 * paths).max(transformed_row * (1 + around));
    // With few disparities, a row of the map with its keys can exceed a row of the volumes.
    let map = 4 * (MapLayout { width, rows: 1 }.words() + u64::from(width));
    let within_paths = (limit / (row * paths.max(1))).saturating_sub(2);
    let within_costs = (limit / transformed_row).saturating_sub(around);
    let rows = within_paths.min(within_costs).min(limit / map);
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
