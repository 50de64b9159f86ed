//! Semi-global matching: the plan.
//!
//! For each view in turn: cost -> a path in each direction -> selection, then the consistency of both.
//! Where the volumes do not fit in a buffer, the pair is matched in bands of rows, from the top to the
//! bottom, with each path going on from band to band. Paths from below need to be known before: they
//! are followed once from the bottom to the top, of which only the row below each band is kept, and
//! then again within each band. So no result depends on where the bands are cut.

use super::{
    band::VolumeBand,
    block_match::Wanted,
    census::{Brightness, Census},
    config::{DenseConfig, View},
    consistency::Consistency,
    cost::{Cost, CostVolume},
    pad::Pad,
    path::{Direction, Path, Penalties},
    plan::{Copy, Plan, Target, match_words},
    refine::plan_refinement,
    select::Select,
};
use crate::{
    disparity::DisparityRange,
    error::{Error, Result},
};

/// Semi-global matching (Hirschmueller, PAMI 2008).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemiGlobal {
    /// How pixels are compared.
    pub cost: Cost,
    /// What changes of disparity cost.
    pub penalties: Penalties,
    /// From how many sides a pixel is reached.
    pub paths: Paths,
}

/// From how many sides a pixel is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paths {
    /// Along its row and its column.
    Four,
    /// From those and along both diagonals.
    Eight,
}

impl Paths {
    /// Their directions.
    pub fn directions(self) -> &'static [Direction] {
        match self {
            Self::Four => &Direction::ALL[..4],
            Self::Eight => &Direction::ALL,
        }
    }
}

impl SemiGlobal {
    /// The bits of a key that are left for the disparity's index.
    pub(super) const INDEX_BITS: u32 = 16;

    /// Refuses what does not fit in the volumes.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the rule.
    pub fn validate(&self) -> Result<()> {
        let Cost { census, difference, gradient } = self.cost;
        for (name, value) in [
            ("the weight of the census", census),
            ("the weight of the difference", difference.weight),
            ("the weight of the gradient", gradient.weight),
            ("the limit of the difference", difference.limit),
            ("the limit of the gradient", gradient.limit),
        ] {
            if value > 1 << 12 {
                return Err(Error::Parameter {
                    name,
                    value: value.to_string(),
                    expected: "it must be 0 to 4096".into(),
                });
            }
        }
        self.penalties.validate()
    }
}

/// What both views share: where their transforms stand, memory for a band of volumes, and a kernel.
struct Shared {
    census: [wgpu::Buffer; 2],
    costs: wgpu::Buffer,
    /// A volume for each path, each with a row in front of it and one behind.
    paths: wgpu::Buffer,
    path_words: u64,
    path: Path,
}

/// One view's kernels, and what it keeps from one band to the next.
struct Side {
    view: View,
    cost: CostVolume,
    directions: &'static [Direction],
    select: Select,
    /// The last row of each path so far; and for each band, the row below it of each path from there.
    carried: Option<wgpu::Buffer>,
    /// In which buffer its answers stand.
    matches: wgpu::Buffer,
}

/// The plan for packed `left` and `right` of `size`, in bands for which no buffer needs more than `limit` bytes, nor more
/// than `band_rows` rows.
pub(super) fn plan(
    device: &wgpu::Device,
    size: (u32, u32),
    config: &DenseConfig,
    semi_global: &SemiGlobal,
    views: [&wgpu::Buffer; 2],
    (limit, band_rows): (u64, u32),
) -> Result<Plan> {
    let (width, height) = size;
    let range = config.searched(width)?;
    let directions = semi_global.paths.directions();
    let band_rows = band_rows_within(limit, size, range, directions.len() as u64, band_rows)?;
    let band = |first_row: u32| VolumeBand { width, first_row, rows: band_rows.min(height - first_row), range };
    let bands: Vec<VolumeBand> = (0..height).step_by(band_rows as usize).map(band).collect();
    let row_words = u64::from(bands[0].row_words());

    let mut plan = Plan::new(bands.len());
    let whole = config.refinement.map(|_| plan.collect(device, size)).transpose()?;
    let padding = Census::padding(size);
    let padded = plan.buffer(device, "padded plane", u64::from(padding.rows) * u64::from(padding.stride))?;
    let (pad, census) = (Pad::new(device), Census::new(device));
    let pixels = u64::from(width) * u64::from(height);
    let transformed = [plan.buffer(device, "census, left", pixels)?, plan.buffer(device, "census, right", pixels)?];
    for ((view, out), brightness) in views.iter().zip(&transformed).zip([Brightness::SAME, config.brightness]) {
        plan.run(pad.prepare(device, padding, view, &padded));
        plan.run(census.prepare(device, size, brightness, &padded, out));
    }

    let path_words = row_words * (u64::from(band_rows) + 2);
    let shared = Shared {
        census: transformed,
        costs: plan.buffer(device, "costs", row_words * u64::from(band_rows))?,
        paths: plan.buffer(device, "paths", path_words * directions.len() as u64)?,
        path_words,
        path: Path::new(device, &semi_global.penalties, bands[0].words()),
    };
    let (match_words, confidence_offset) = match_words(width, band_rows);
    let mut side = |view: View, wanted: Wanted| -> Result<Side> {
        let kept = (bands.len() > 1).then_some(row_words * directions.len() as u64 * (bands.len() as u64 + 1));
        let matches = match wanted {
            Wanted::Matches => plan.buffer(device, "matches", match_words)?,
            Wanted::Winners => plan.buffer(device, "winners of the other view", confidence_offset.into())?,
        };
        let paths = directions.len() as u32;
        let interpolation = config.interpolation;
        Ok(Side {
            view,
            cost: CostVolume::new(device, &semi_global.cost, view),
            directions,
            select: Select::new(device, paths, interpolation, wanted, config.uniqueness),
            carried: kept.map(|words| plan.buffer(device, "paths between bands", words)).transpose()?,
            matches,
        })
    };
    let mut sides = vec![side(config.reference, Wanted::Matches)?];
    if config.consistency.is_some() {
        sides.push(side(config.reference.other(), Wanted::Winners)?);
    }

    for side in &sides {
        side.follow_from_below(device, &mut plan, &shared, &bands);
    }
    let consistency = Consistency::new(device);
    for (index, band) in bands.iter().enumerate() {
        for side in &sides {
            side.match_band(device, &mut plan, &shared, &bands, index, confidence_offset);
        }
        let matches = &sides[0].matches;
        if let (Some(limit), Some(other)) = (config.consistency, sides.get(1)) {
            let (size, view) = ((width, band.rows), config.reference);
            let others = &other.matches;
            plan.run(consistency.prepare(device, size, confidence_offset, view, limit, others, matches));
        }
        plan.hand_out(matches, confidence_offset, width, (band.first_row, band.rows));
    }
    if let (Some(whole), Some(refinement)) = (whole, &config.refinement) {
        let luma = if config.reference == View::Left { views[0] } else { views[1] };
        plan_refinement(device, &mut plan, size, refinement, range, luma, &whole)?;
    }
    Ok(plan)
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

    /// Follows the paths from below from the last band to the second, and keeps the row below each band.
    fn follow_from_below(&self, device: &wgpu::Device, plan: &mut Plan, shared: &Shared, bands: &[VolumeBand]) {
        let Some(carried) = &self.carried else { return };
        let [reference, other] = self.census(shared);
        for (index, band) in bands.iter().enumerate().skip(1).rev() {
            plan.run(self.cost.prepare(device, band, [reference, other], &shared.costs));
            for (number, &direction) in self.directions.iter().enumerate() {
                if direction.dy >= 0 {
                    continue;
                }
                let goes_on = index + 1 < bands.len();
                if goes_on {
                    self.bring(plan, shared, band, number, index + 1, carried);
                }
                let row = u64::from(band.row_words());
                let start = number as u64 * shared.path_words + row;
                let (costs, paths) = (&shared.costs, &shared.paths);
                plan.run(shared.path.prepare(device, band, direction, reference, costs, paths, start as u32, goes_on));
                plan.copy(Copy {
                    from: paths.clone(),
                    from_word: start,
                    to: Target::Buffer(carried.clone()),
                    to_word: self.kept(band, number, index),
                    words: row,
                });
            }
        }
    }

    /// Where the row is kept that a path of number `number` enters the band in front of, or behind, band `index` with.
    fn kept(&self, band: &VolumeBand, number: usize, index: usize) -> u64 {
        u64::from(band.row_words()) * (index * self.directions.len() + number) as u64
    }

    /// Copies a kept row to where a path goes on from it: in front of the band, or behind it.
    fn bring(
        &self,
        plan: &mut Plan,
        shared: &Shared,
        band: &VolumeBand,
        number: usize,
        kept: usize,
        carried: &wgpu::Buffer,
    ) {
        let row = u64::from(band.row_words());
        let before = if self.directions[number].dy > 0 { 0 } else { u64::from(band.rows) + 1 };
        plan.copy(Copy {
            from: carried.clone(),
            from_word: self.kept(band, number, kept),
            to: Target::Buffer(shared.paths.clone()),
            to_word: number as u64 * shared.path_words + before * row,
            words: row,
        });
    }

    /// Costs, paths and answers of a band.
    fn match_band(
        &self,
        device: &wgpu::Device,
        plan: &mut Plan,
        shared: &Shared,
        bands: &[VolumeBand],
        index: usize,
        confidence_offset: u32,
    ) {
        let band = &bands[index];
        let [reference, other] = self.census(shared);
        let (costs, paths) = (&shared.costs, &shared.paths);
        let row = u64::from(band.row_words());
        plan.run(self.cost.prepare(device, band, [reference, other], costs));
        for (number, &direction) in self.directions.iter().enumerate() {
            let goes_on = match direction.dy {
                0 => false,
                1.. => index > 0,
                _ => index + 1 < bands.len(),
            };
            let start = number as u64 * shared.path_words + row;
            if let (Some(carried), true) = (&self.carried, goes_on) {
                // Rows from above are kept in front of all others, in the place of band 0.
                self.bring(plan, shared, band, number, if direction.dy > 0 { 0 } else { index + 1 }, carried);
            }
            plan.run(shared.path.prepare(device, band, direction, reference, costs, paths, start as u32, goes_on));
            if let (Some(carried), 1) = (&self.carried, direction.dy) {
                plan.copy(Copy {
                    from: paths.clone(),
                    from_word: start + row * u64::from(band.rows - 1),
                    to: Target::Buffer(carried.clone()),
                    to_word: self.kept(band, number, 0),
                    words: row,
                });
            }
        }
        let volume = shared.path_words as u32;
        plan.run(self.select.prepare(device, band, paths, row as u32, volume, &self.matches, confidence_offset));
    }
}

/// The most rows, up to `wanted`, for which the volumes of a band stay within `limit` bytes.
fn band_rows_within(
    limit: u64,
    (width, height): (u32, u32),
    range: DisparityRange,
    paths: u64,
    wanted: u32,
) -> Result<u32> {
    let row = 4 * u64::from(width) * u64::from(range.count.div_ceil(4));
    let needed = 3 * row * paths;
    let rows = (limit / (row * paths)).saturating_sub(2);
    if rows == 0 {
        return Err(Error::TooLarge {
            what: format!("one row of a picture {width} px wide with {} disparities", range.count),
            needed,
            limit,
            way_out: "search fewer disparities or scale the pictures down".into(),
        });
    }
    Ok(u32::try_from(rows).unwrap_or(u32::MAX).min(wanted).min(height).max(1))
}
