//! Semi-global matching: paths, selection, and claims.

use super::{
    blocks::signed,
    costs::lumas,
    words::{bytes, words},
};
use crate::{
    cpu::dense::{claim, path, path_winners, select},
    dense::{
        DenseConfig, Direction, Interpolation, Penalties, View,
        kernels::{
            Claim, LineBuffers, MapBuffer, MapLayout, Path, PathVolumes, ResultKind, Select, Selection, VolumeBand,
        },
    },
    disparity::{DisparityRange, NONE, SCALE},
    error::Result,
    image::{Plane, Size},
    luma::pack,
    verify::{
        dice::smooth_noise,
        trial::{Array, Bench, Dice, Subject, Trial},
    },
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("path", |size, dice| Box::new(PathTrial::draw(size, dice))),
    Subject::kernel("select", |size, dice| Box::new(SelectTrial::draw(size, dice))),
    Subject::kernel("claim", |size, dice| Box::new(ClaimTrial::draw(size, dice))),
];

pub(super) fn penalties(dice: &mut Dice) -> Penalties {
    let p2 = 1 + dice.below(128);
    let least_p2 = 1 + dice.below(p2);
    Penalties { p1: dice.below(least_p2 + 1), p2, least_p2, p2_scale: dice.pick(&[1, 8, 16, 255]) }
}

/// Costs of all pixels, 0 to 127, padded to a multiple of 16 disparities.
pub(super) fn costs(Size { width, height }: Size, count: u32, seed: u32) -> Vec<u8> {
    let noise = smooth_noise((width * DisparityRange::padded(count), height), seed);
    noise.data().iter().map(|&value| value / 2).collect()
}

/// Costs for a path.
#[derive(Clone, Debug)]
pub struct PathTrial {
    /// The reference view, its luma in the lowest byte.
    pub reference: Plane<u32>,
    /// Costs of each pixel, a multiple of 16 disparities.
    pub costs: Vec<u8>,
    /// Direction of the path.
    pub direction: Direction,
    /// Penalties for changes of disparity.
    pub penalties: Penalties,
    /// Rows per band; each band continues the paths of the previous one.
    pub band_rows: u32,
}

impl PathTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (penalties, count) = (penalties(dice), dice.pick(&[16, 32, 80]));
        let direction = dice.pick(&Direction::ALL);
        let band_rows = if dice.coin() { size.height } else { 1 + dice.below(size.height) };
        let high_bits = dice.word() << 8;
        let reference = dice.picture(size).map(|&value| u32::from(value) | high_bits);
        Self { reference, costs: costs(size, count, dice.word()), direction, penalties, band_rows }
    }
}

impl Trial for PathTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} in bands of {} rows", self.direction, self.penalties, self.band_rows)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("reference", self.reference.data().to_vec()), Array::exact("costs", self.costs.clone())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Self { reference, direction, .. } = self;
        let Size { width, height } = reference.size();
        let count = self.costs.len() as u32 / (width * height);
        let kernel = Path::new(bench.gpu, &self.penalties, count / 4);
        let view = bench.upload(&lumas(reference))?;
        let costs = words(&self.costs);
        let mut path = vec![0; costs.len()];
        let mut firsts: Vec<u32> = (0..height).step_by(self.band_rows as usize).collect();
        if direction.dy < 0 {
            firsts.reverse();
        }
        let mut carried: Option<Vec<u32>> = None;
        for first_row in firsts {
            let rows = self.band_rows.min(height - first_row);
            let band = VolumeBand { width, first_row, rows, range: DisparityRange { min: 0, count } };
            let row = band.row_words() as usize;
            // One halo row on either side, from which lines come.
            let mut paths = vec![u32::MAX; row * (rows as usize + 2)];
            if let Some(carried) = &carried {
                let at = if direction.dy < 0 { row * (rows as usize + 1) } else { 0 };
                paths[at..at + row].copy_from_slice(carried);
            }
            let paths = bench.upload(&paths)?;
            let band_words = row * first_row as usize..row * (first_row + rows) as usize;
            let costs = bench.upload(&costs[band_words.clone()])?;
            let lines = LineBuffers { reference: &view, costs: &costs, paths: &paths };
            let goes_on = carried.is_some() && direction.dy != 0;
            let dispatch = kernel.prepare(&band, *direction, lines, row as u32, goes_on);
            bench.run(|encoder| dispatch.record(encoder));
            let followed = bench.download::<u32>(&paths)?;
            path[band_words].copy_from_slice(&followed[row..row * (rows as usize + 1)]);
            let last = if direction.dy < 0 { 1 } else { rows as usize };
            carried = Some(followed[last * row..(last + 1) * row].to_vec());
        }
        Ok(vec![Array::exact("path", bytes(&path))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("path", path(&self.reference, &self.costs, &self.penalties, self.direction))])
    }
}

/// The costs of several paths; the kernel follows the last one itself.
#[derive(Clone, Debug)]
pub struct SelectTrial {
    /// The reference view, its luma in the lowest byte.
    pub reference: Plane<u32>,
    /// The matching costs for the last path.
    pub costs: Vec<u8>,
    /// The costs along the stored paths.
    pub stored: Vec<Vec<u8>>,
    /// The disparities.
    pub range: DisparityRange,
    /// Direction of the last path, along the rows.
    pub last: Direction,
    /// Penalties of the last path.
    pub penalties: Penalties,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// See [`crate::dense::DenseParameters::uniqueness`].
    pub uniqueness: u32,
}

impl SelectTrial {
    fn arrays(disparities: Vec<i32>, confidences: Vec<u32>, keys: Vec<u32>) -> Vec<Array> {
        vec![
            Array::exact("disparities", disparities),
            Array::exact("confidences", confidences),
            Array::exact("keys", keys),
        ]
    }
}

impl SelectTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (stored, count) = (dice.pick(&[1, 2, 3, 7]), dice.pick(&[1_u32, 2, 17, 40, 61]));
        let (penalties, interpolation) = (penalties(dice), dice.interpolation());
        let uniqueness = dice.pick(&[0, 1, 10, 100]);
        let volume = |seed| smooth_noise((size.width * DisparityRange::padded(count), size.height), seed).into_data();
        Self {
            range: DisparityRange { min: dice.between(-9, 9), count },
            last: dice.pick(&Direction::ALL[..2]),
            reference: dice.picture(size).map(|&value| value.into()),
            costs: costs(size, count, dice.word()),
            stored: (0..stored).map(|_| volume(dice.word())).collect(),
            penalties,
            interpolation,
            uniqueness,
        }
    }
}

impl Trial for SelectTrial {
    fn parameters(&self) -> String {
        let Self { range, last, penalties, interpolation, uniqueness, .. } = self;
        format!("{range:?} {last:?} {penalties:?} {interpolation:?} uniqueness {uniqueness}")
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("reference", self.reference.data().to_vec()),
            Array::exact("costs", self.costs.clone()),
            Array::exact("paths", self.stored.concat()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height: rows }) = (bench.gpu, self.reference.size());
        let band = VolumeBand { width, first_row: 0, rows, range: self.range };
        let layout = MapLayout { width, rows };
        let volumes = PathVolumes { start: 0, volume_words: band.row_words() * rows };
        let selection = Selection {
            stored: self.stored.len() as u32,
            interpolation: self.interpolation,
            kind: ResultKind::Matches,
            keys: true,
            uniqueness: self.uniqueness,
        };
        let kernel = Select::new(gpu, &self.penalties, band.words(), selection);
        // The kernel expects zeros.
        let matches = bench.upload(&vec![0_u32; (layout.words() as u32 + layout.pixels()) as usize])?;
        let (reference, costs) = (bench.upload(&lumas(&self.reference))?, bench.upload(&words(&self.costs))?);
        let stored = bench.upload(&words(&self.stored.concat()))?;
        let lines = LineBuffers { reference: &reference, costs: &costs, paths: &stored };
        let dispatch = kernel.prepare(&band, self.last, lines, volumes, MapBuffer { buffer: &matches, layout });
        bench.run(|encoder| dispatch.record(encoder));
        let matches = bench.download::<u32>(&matches)?;
        let (map, keys) = matches.split_at(layout.key_offset() as usize);
        let (disparities, confidences) = map.split_at(layout.confidence_offset() as usize);
        Ok(Self::arrays(signed(disparities), confidences.to_vec(), keys.to_vec()))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Self { interpolation, uniqueness, range, .. } = *self;
        let config = DenseConfig::new(range).with(|parameters| {
            parameters.interpolation = interpolation;
            parameters.uniqueness = uniqueness;
        });
        let mut volumes = self.stored.clone();
        volumes.push(path(&self.reference, &self.costs, &self.penalties, self.last));
        let size = self.reference.size();
        let dense = select(&volumes, size, &config);
        let key = |winner: &Option<(u32, i32)>| {
            winner.map_or(u32::MAX, |(cost, disparity)| cost << 16 | (disparity - range.min) as u32)
        };
        let keys = path_winners(&volumes, size, &config).map(key).into_data();
        Ok(Self::arrays(dense.disparity.into_data(), pack(&dense.confidence), keys))
    }
}

/// Winners of one view that claim their partners in the other.
#[derive(Clone, Debug)]
pub struct ClaimTrial {
    /// Winners: costs, and disparities in pixels.
    pub winners: Plane<Option<(u32, i32)>>,
    /// The view of the winners.
    pub view: View,
    /// Range of the disparities.
    pub range: DisparityRange,
    /// Rows allocated in the map beyond those of the winners.
    pub spare_rows: u32,
}

impl ClaimTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (view, range, spare_rows) = (dice.view(), dice.range(60), dice.below(7));
        let few = dice.coin();
        let winners = Plane::from_fn(size, |_, _| {
            // With few different costs many claims tie.
            let cost = if few { dice.below(3) } else { dice.below(2040) };
            let disparity = range.min + dice.below(range.count) as i32;
            (dice.below(8) > 0).then_some((cost, disparity))
        });
        Self { winners, view, range, spare_rows }
    }
}

impl Trial for ClaimTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?}, {} rows to spare", self.view, self.range, self.spare_rows)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("keys", self.keys())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height: rows } = self.winners.size();
        let layout = MapLayout { width, rows: rows + self.spare_rows };
        // The map in front of the keys.
        let mut matches = vec![7; layout.key_offset() as usize];
        matches.extend(self.keys());
        // The kernel expects zeros.
        let claims = bench.upload(&vec![0_u32; (width * rows) as usize])?;
        let band = VolumeBand { width, first_row: 0, rows, range: self.range };
        let kernel = Claim::new(bench.gpu);
        let matches = bench.upload(&matches)?;
        let dispatch = kernel.prepare(&band, self.view, MapBuffer { buffer: &matches, layout }, &claims);
        bench.run(|encoder| dispatch.record(encoder));
        let disparity = |claim: u32| match claim {
            0 => NONE,
            claim => (self.range.min + (!claim & 0xffff) as i32) * SCALE,
        };
        let disparities: Vec<i32> = bench.download(&claims)?.into_iter().map(disparity).collect();
        Ok(vec![Array::exact("claimed disparities", disparities)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("claimed disparities", claim(&self.winners, self.view).into_data())])
    }
}

impl ClaimTrial {
    /// The winners as keys, as [`Select`] writes them.
    fn keys(&self) -> Vec<u32> {
        let key = |(cost, disparity): (u32, i32)| cost << 16 | (disparity - self.range.min) as u32;
        self.winners.data().iter().map(|winner| winner.map_or(u32::MAX, key)).collect()
    }
}
