//! Levels of a pyramid: matching cost, path and selection where each cell has a range of its own.

use super::{
    blocks::signed,
    costs::{lumas, transforms, weak_spread},
    paths::penalties,
    words::{bytes, words},
};
use crate::{
    cpu::dense::{CellVolume, Transforms, cell_cost, cell_path, cell_select},
    dense::{
        Cost, DenseConfig, Difference, Direction, Interpolation, Penalties, View,
        kernels::{
            CellCost, CellLayout, CellPath, CellSelect, LevelBand, LineBuffers, MapBuffer, MapLayout, PIXELS_HARDWARE,
            PIXELS_SOFTWARE, PathVolumes, ResultKind, Selection,
        },
        pyramid::{CellRange, CellTable},
    },
    disparity::DisparityRange,
    error::Result,
    image::{Plane, Size},
    luma::pack,
    verify::{
        dice::smooth_noise,
        trial::{Array, Bench, Dice, Subject, Trial},
    },
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("cell_cost", |size, dice| Box::new(CellCostTrial::draw(size, dice))),
    Subject::kernel("cell_path", |size, dice| Box::new(CellPathTrial::draw(size, dice))),
    Subject::kernel("cell_select", |size, dice| Box::new(CellSelectTrial::draw(size, dice))),
];

/// A table whose cells have parts of a range of at most `most` disparities.
fn table(size: Size, most: u32, dice: &mut Dice) -> CellTable {
    let range = DisparityRange { min: dice.between(-20, 20), count: 1 + dice.below(most) };
    let whole = CellTable::whole(size, range);
    let all = CellRange::whole(range.count).words;
    let cells = whole.cells.map(|_| {
        let words = 4 * (1 + dice.below(all / 4));
        let cell = CellRange { first: dice.below(all - words + 1), words };
        // A cell has at least one disparity of the range.
        if 4 * cell.first < range.count { cell } else { CellRange::whole(range.count) }
    });
    CellTable { cells, ..whole }
}

fn ranges_of(table: &CellTable) -> Array {
    let words = table.cells.data().iter().flat_map(|cell| [cell.first, cell.words]);
    Array::exact("ranges of cells", words.collect::<Vec<u32>>())
}

/// Values of all pixels at the disparities of their cells.
fn volume(table: &CellTable, seed: u32, most: u8) -> CellVolume {
    let count = *CellVolume::starts(table).last().expect("an end") as u32;
    let noise = smooth_noise((count, 1), seed).into_data();
    CellVolume { table: table.clone(), values: noise.into_iter().map(|value| value.min(most)).collect() }
}

/// Bands of `rows` rows of a picture of `height` rows.
fn bands_of(height: u32, rows: u32) -> Vec<std::ops::Range<u32>> {
    (0..height).step_by(rows as usize).map(|first| first..(first + rows).min(height)).collect()
}

/// Two census transforms whose pixels are compared at the disparities of their cells.
#[derive(Clone, Debug)]
pub struct CellCostTrial {
    /// Census transforms of the reference and of the other view.
    pub views: [Transforms; 2],
    /// The reference view.
    pub view: View,
    /// The matching cost.
    pub cost: Cost,
    /// The disparities of the cells.
    pub table: CellTable,
    /// Most rows of a band.
    pub band_rows: u32,
    /// Pixels of a row per thread.
    pub pixels: u32,
}

impl CellCostTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let mut part = || Difference { weight: dice.below(40), limit: dice.below(60) };
        let (difference, gradient) = (part(), part());
        let weak_spread = weak_spread(dice);
        let cost = Cost { census: dice.pick(&[0, 20, 40]), difference, gradient, weak_spread };
        let (view, table) = (dice.view(), table(size, 90, dice));
        let views = dice.pair(size).map(|luma| Transforms::new(&luma, &cost));
        let band_rows = 1 + dice.below(size.height);
        Self { views, view, cost, table, band_rows, pixels: dice.pick(&[PIXELS_SOFTWARE, PIXELS_HARDWARE]) }
    }
}

impl Trial for CellCostTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} {:?} in bands of {} rows", self.view, self.cost, self.table.range, self.band_rows)
    }

    fn input(&self) -> Vec<Array> {
        let [reference, other] = self.views.each_ref().map(transforms);
        vec![Array::exact("reference", reference), Array::exact("other", other), ranges_of(&self.table)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.table.size;
        let bands = bands_of(height, self.band_rows);
        let layout = CellLayout::new(bench.gpu, &self.table, &bands)?;
        let views = [&bench.upload(&transforms(&self.views[0]))?, &bench.upload(&transforms(&self.views[1]))?];
        let kernel = CellCost::new(bench.gpu, &self.cost, self.view, self.pixels);
        let mut costs = Vec::new();
        for rows in bands {
            let volume = bench.output(layout.words_of(rows.clone()) as u32)?;
            let (top, first_row, rows) = (rows.start, rows.start, rows.len() as u32);
            let band = LevelBand { layout: &layout, width, top, first_row, rows };
            let dispatch = kernel.prepare(&band, self.table.range.min, views, &volume);
            bench.run(|encoder| dispatch.record(encoder));
            costs.extend(bytes(&bench.download(&volume)?));
        }
        Ok(vec![Array::exact("costs", costs)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let [reference, other] = &self.views;
        Ok(vec![Array::exact("costs", cell_cost([reference, other], self.view, &self.cost, &self.table).values)])
    }
}

/// Costs for a path through cells.
#[derive(Clone, Debug)]
pub struct CellPathTrial {
    /// The reference view, its luma in the lowest byte.
    pub reference: Plane<u32>,
    /// The matching costs.
    pub costs: CellVolume,
    /// Direction of the path.
    pub direction: Direction,
    /// Penalties for changes of disparity.
    pub penalties: Penalties,
    /// Rows per band; each band continues the paths of the previous one.
    pub band_rows: u32,
}

impl CellPathTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (penalties, direction, table) = (penalties(dice), dice.pick(&Direction::ALL), table(size, 90, dice));
        let band_rows = if dice.coin() { size.height } else { 1 + dice.below(size.height) };
        let reference = dice.picture(size).map(|&value| value.into());
        Self { reference, costs: volume(&table, dice.word(), 127), direction, penalties, band_rows }
    }
}

impl Trial for CellPathTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} in bands of {} rows", self.direction, self.penalties, self.band_rows)
    }

    fn input(&self) -> Vec<Array> {
        let reference = Array::exact("reference", self.reference.data().to_vec());
        vec![reference, Array::exact("costs", self.costs.values.clone()), ranges_of(&self.costs.table)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Self { direction, costs: CellVolume { table, values }, .. } = self;
        let Size { width, height } = table.size;
        let mut bands = bands_of(height, self.band_rows);
        let layout = CellLayout::new(bench.gpu, table, &bands)?;
        let kernel = CellPath::new(bench.gpu, &self.penalties);
        let view = bench.upload(&lumas(&self.reference))?;
        let costs = words(values);
        let mut path = vec![0; costs.len()];
        if direction.dy < 0 {
            bands.reverse();
        }
        let words_of = |rows: std::ops::Range<u32>| layout.words_of(rows) as usize;
        let mut carried: Option<Vec<u32>> = None;
        for rows in bands {
            let (start, count) = (words_of(0..rows.start), words_of(rows.clone()));
            // The row before the band in front of it or behind it, as the path goes.
            let before = carried.take().filter(|_| direction.dy != 0).unwrap_or_default();
            let halo = (!before.is_empty()).then_some(if direction.dy < 0 { count as u32 } else { 0 });
            let band_start = if direction.dy < 0 { 0 } else { before.len() };
            let mut paths = vec![u32::MAX; count + before.len()];
            let at = halo.unwrap_or(0) as usize;
            paths[at..at + before.len()].copy_from_slice(&before);
            let paths = bench.upload(&paths)?;
            let costs = bench.upload(&costs[start..start + count])?;
            let lines = LineBuffers { reference: &view, costs: &costs, paths: &paths };
            let (top, first_row) = (rows.start, rows.start);
            let band = LevelBand { layout: &layout, width, top, first_row, rows: rows.len() as u32 };
            let parts = kernel.prepare(&band, *direction, lines, band_start as u32, halo);
            bench.run(|encoder| parts.iter().for_each(|part| part.record(encoder)));
            let followed = bench.download::<u32>(&paths)?[band_start..band_start + count].to_vec();
            let last = if direction.dy < 0 { rows.start } else { rows.end - 1 };
            let kept = words_of(rows.start..last);
            carried = Some(followed[kept..kept + words_of(last..last + 1)].to_vec());
            path[start..start + count].copy_from_slice(&followed);
        }
        Ok(vec![Array::exact("path", bytes(&path))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let path = cell_path(&self.reference, &self.costs, &self.penalties, self.direction);
        Ok(vec![Array::exact("path", path.values)])
    }
}

/// The costs of several paths through cells.
#[derive(Clone, Debug)]
pub struct CellSelectTrial {
    /// The costs along the paths.
    pub paths: Vec<CellVolume>,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// See [`crate::dense::DenseParameters::uniqueness`].
    pub uniqueness: u32,
}

impl CellSelectTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (paths, table) = (dice.pick(&[1, 3, 4, 8]), table(size, 90, dice));
        let (interpolation, uniqueness) = (dice.interpolation(), dice.pick(&[0, 1, 10, 100]));
        Self { paths: (0..paths).map(|_| volume(&table, dice.word(), 255)).collect(), interpolation, uniqueness }
    }

    fn arrays(disparities: Vec<i32>, confidences: Vec<u32>, keys: Vec<u32>) -> Vec<Array> {
        vec![
            Array::exact("disparities", disparities),
            Array::exact("confidences", confidences),
            Array::exact("keys", keys),
        ]
    }
}

impl Trial for CellSelectTrial {
    fn parameters(&self) -> String {
        let Self { paths, interpolation, uniqueness } = self;
        format!("{} paths {:?} {interpolation:?} uniqueness {uniqueness}", paths.len(), paths[0].table.range)
    }

    fn input(&self) -> Vec<Array> {
        let values: Vec<u8> = self.paths.iter().flat_map(|path| path.values.iter().copied()).collect();
        vec![Array::exact("paths", values), ranges_of(&self.paths[0].table)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let table = &self.paths[0].table;
        let Size { width, height: rows } = table.size;
        let layout = CellLayout::new(bench.gpu, table, &bands_of(rows, rows))?;
        let map = MapLayout { width, rows };
        let selection = Selection {
            stored: self.paths.len() as u32,
            interpolation: self.interpolation,
            kind: ResultKind::Matches,
            keys: true,
            uniqueness: self.uniqueness,
        };
        let matches = bench.output(map.words() as u32 + map.pixels())?;
        let paths: Vec<u32> = self.paths.iter().flat_map(|path| words(&path.values)).collect();
        let volumes = PathVolumes { start: 0, volume_words: (paths.len() / self.paths.len()) as u32 };
        let band = LevelBand { layout: &layout, width, top: 0, first_row: 0, rows };
        let buffer = MapBuffer { buffer: &matches, layout: map };
        let dispatch =
            CellSelect::new(bench.gpu, selection).prepare(&band, table.range, &bench.upload(&paths)?, volumes, buffer);
        bench.run(|encoder| dispatch.record(encoder));
        let matches = bench.download::<u32>(&matches)?;
        let (map_words, keys) = matches.split_at(map.key_offset() as usize);
        let (disparities, confidences) = map_words.split_at(map.confidence_offset() as usize);
        Ok(Self::arrays(signed(disparities), confidences.to_vec(), keys.to_vec()))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let range = self.paths[0].table.range;
        let config = DenseConfig::new(range).with(|parameters| {
            parameters.interpolation = self.interpolation;
            parameters.uniqueness = self.uniqueness;
        });
        let (dense, winners) = cell_select(&self.paths, &config);
        let key = |winner: &Option<(u32, i32)>| {
            winner.map_or(u32::MAX, |(cost, disparity)| cost << 16 | (disparity - range.min) as u32)
        };
        Ok(Self::arrays(dense.disparity.into_data(), pack(&dense.confidence), winners.map(key).into_data()))
    }
}
