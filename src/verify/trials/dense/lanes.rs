//! Semi-global matching with threads across disparities: paths and selection.

use super::{
    blocks::signed,
    costs::lumas,
    paths::{costs, penalties},
    words::{bytes, words},
};
use crate::{
    cpu::dense::{path, path_winners, select},
    dense::{
        DenseConfig, Direction, Interpolation, Penalties,
        kernels::{
            LanePath, LaneSelect, Lanes, LineBuffers, MapBuffer, MapLayout, PathVolumes, ResultKind, Selection,
            VolumeBand,
        },
    },
    disparity::DisparityRange,
    error::Result,
    gpu::{Exchange, Shapes},
    image::{Plane, Size},
    luma::pack,
    verify::{
        dice::smooth_noise,
        trial::{Array, Bench, Dice, Subject, Trial},
    },
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("lane_path", |size, dice| Box::new(LanePathTrial::draw(size, dice))),
    Subject::kernel("lane_select", |size, dice| Box::new(LaneSelectTrial::draw(size, dice))),
];

/// Why each trial has threads.
const FEW: &str = "few disparities in a trial";

/// Costs for several paths.
#[derive(Clone, Debug)]
pub struct LanePathTrial {
    /// The reference view, its luma in the lowest byte.
    pub reference: Plane<u32>,
    /// Costs of each pixel, a multiple of 16 disparities.
    pub costs: Vec<u8>,
    /// Directions of the paths.
    pub directions: Vec<Direction>,
    /// Penalties for changes of disparity.
    pub penalties: Penalties,
    /// Rows per band; each band continues the paths of the previous one. In several bands one path is followed at a time.
    pub band_rows: u32,
    /// See [`Shapes::lane_disparities`].
    pub lane_disparities: u32,
    /// See [`Shapes::lane_threads`].
    pub lane_threads: u32,
    /// By what threads exchange path costs, if the device can.
    pub exchange: Exchange,
}

impl LanePathTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (penalties, count) = (penalties(dice), dice.pick(&[16, 32, 80, 144]));
        let directions = Direction::ALL[..dice.pick(&[1, 3, 4, 8])].to_vec();
        let band_rows = if dice.coin() { size.height } else { 1 + dice.below(size.height) };
        let high_bits = dice.word() << 8;
        let reference = dice.picture(size).map(|&value| u32::from(value) | high_bits);
        let costs = costs(size, count, dice.word());
        let (lane_threads, exchange) = (dice.pick(&Shapes::LANE_THREADS), dice.pick(&Exchange::ALL));
        let lane_disparities = dice.pick(&Shapes::LANE_DISPARITIES);
        Self { reference, costs, directions, penalties, band_rows, lane_disparities, lane_threads, exchange }
    }

    /// The volumes of `directions` in the band of `rows` rows from `first_row`, whose lines continue from `carried`, and the halo
    /// rows of each.
    fn followed(
        &self,
        bench: &Bench<'_>,
        directions: &[Direction],
        (first_row, rows): (u32, u32),
        carried: Option<&[u32]>,
    ) -> Result<Vec<Vec<u32>>> {
        let Size { width, height } = self.reference.size();
        let count = self.costs.len() as u32 / (width * height);
        let band = VolumeBand { width, first_row, rows, range: DisparityRange { min: 0, count } };
        let Self { lane_disparities, lane_threads, exchange, .. } = *self;
        let gpu = bench.gpu;
        let gpu = gpu.clone().with_shapes(Shapes { lane_disparities, lane_threads, exchange, ..gpu.shapes() });
        let kernel = LanePath::new(&gpu, &self.penalties, Lanes::of_line(&gpu, &band).expect(FEW));
        let row = band.row_words() as usize;
        let volume_words = row * (rows as usize + 2);
        let mut volumes = vec![u32::MAX; volume_words * directions.len()];
        if let Some(carried) = carried {
            let at = if directions[0].dy < 0 { row * (rows as usize + 1) } else { 0 };
            volumes[at..at + row].copy_from_slice(carried);
        }
        let first_word = row * first_row as usize;
        let band_costs = &words(&self.costs)[first_word..first_word + row * rows as usize];
        let (view, costs) = (bench.upload(&lumas(&self.reference))?, bench.upload(band_costs)?);
        let volumes = bench.upload(&volumes)?;
        let lines = LineBuffers { reference: &view, costs: &costs, paths: &volumes };
        let paths: Vec<_> = directions.iter().map(|&direction| (direction, carried.is_some())).collect();
        let layout = PathVolumes { start: row as u32, volume_words: volume_words as u32 };
        let dispatch = kernel.prepare(&band, &paths, lines, layout);
        bench.run(|encoder| dispatch.record(encoder));
        let without_halo = |volume: &[u32]| volume[row..volume_words - row].to_vec();
        Ok(bench.download::<u32>(&volumes)?.chunks(volume_words).map(without_halo).collect())
    }
}

impl Trial for LanePathTrial {
    fn parameters(&self) -> String {
        let Self { directions, penalties, band_rows, lane_disparities, lane_threads, exchange, .. } = self;
        format!(
            "{directions:?} {penalties:?} in bands of {band_rows} rows, {lane_disparities} disparities per thread, {lane_threads} threads, \
             {exchange}"
        )
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("reference", self.reference.data().to_vec()), Array::exact("costs", self.costs.clone())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { height, .. } = self.reference.size();
        if self.band_rows >= height {
            let volumes = self.followed(bench, &self.directions, (0, height), None)?;
            return Ok(vec![Array::exact("paths", bytes(&volumes.concat()))]);
        }
        let row = self.costs.len() / 4 / height as usize;
        let mut volumes = Vec::new();
        for direction in &self.directions {
            let mut bands: Vec<u32> = (0..height).step_by(self.band_rows as usize).collect();
            if direction.dy < 0 {
                bands.reverse();
            }
            let mut volume = vec![0; self.costs.len() / 4];
            let mut carried: Option<Vec<u32>> = None;
            for first_row in bands {
                let rows = self.band_rows.min(height - first_row);
                let carried_on = carried.take().filter(|_| direction.dy != 0);
                let followed = &self.followed(bench, &[*direction], (first_row, rows), carried_on.as_deref())?[0];
                volume[first_row as usize * row..][..followed.len()].copy_from_slice(followed);
                let last = if direction.dy < 0 { 0 } else { rows as usize - 1 };
                carried = Some(followed[last * row..(last + 1) * row].to_vec());
            }
            volumes.extend(volume);
        }
        Ok(vec![Array::exact("paths", bytes(&volumes))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let volume = |&direction: &Direction| path(&self.reference, &self.costs, &self.penalties, direction);
        Ok(vec![Array::exact("paths", self.directions.iter().flat_map(volume).collect::<Vec<_>>())])
    }
}

/// The costs of several paths.
#[derive(Clone, Debug)]
pub struct LaneSelectTrial {
    /// Width and height of the view.
    pub size: Size,
    /// The costs along the paths.
    pub paths: Vec<Vec<u8>>,
    /// The disparities.
    pub range: DisparityRange,
    /// Sub-pixel interpolation.
    pub interpolation: Interpolation,
    /// See [`crate::dense::DenseParameters::uniqueness`].
    pub uniqueness: u32,
    /// See [`Shapes::lane_threads`].
    pub lane_threads: u32,
}

impl LaneSelectTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (paths, count) = (dice.pick(&[1, 3, 4, 8]), dice.pick(&[1_u32, 2, 17, 40, 130]));
        let (interpolation, uniqueness) = (dice.interpolation(), dice.pick(&[0, 1, 10, 100]));
        let volume = |seed| smooth_noise((size.width * DisparityRange::padded(count), size.height), seed).into_data();
        let range = DisparityRange { min: dice.between(-9, 9), count };
        let paths = (0..paths).map(|_| volume(dice.word())).collect();
        Self { size, paths, range, interpolation, uniqueness, lane_threads: dice.pick(&Shapes::LANE_THREADS) }
    }

    fn arrays(disparities: Vec<i32>, confidences: Vec<u32>, keys: Vec<u32>) -> Vec<Array> {
        vec![
            Array::exact("disparities", disparities),
            Array::exact("confidences", confidences),
            Array::exact("keys", keys),
        ]
    }
}

impl Trial for LaneSelectTrial {
    fn parameters(&self) -> String {
        let Self { paths, range, interpolation, uniqueness, lane_threads, .. } = self;
        let paths = paths.len();
        format!("{paths} paths {range:?} {interpolation:?} uniqueness {uniqueness}, {lane_threads} threads")
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("paths", self.paths.concat())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height: rows } = self.size;
        let band = VolumeBand { width, first_row: 0, rows, range: self.range };
        let layout = MapLayout { width, rows };
        let volumes = PathVolumes { start: 0, volume_words: band.row_words() * rows };
        let selection = Selection {
            stored: self.paths.len() as u32,
            interpolation: self.interpolation,
            kind: ResultKind::Matches,
            keys: true,
            uniqueness: self.uniqueness,
        };
        let gpu = bench.gpu;
        let gpu = gpu.clone().with_shapes(Shapes { lane_threads: self.lane_threads, ..gpu.shapes() });
        let kernel = LaneSelect::new(&gpu, Lanes::of_pixel(&gpu, &band).expect(FEW), selection);
        // The kernel expects zeros.
        let matches = bench.upload(&vec![0_u32; (layout.words() as u32 + layout.pixels()) as usize])?;
        let paths = bench.upload(&words(&self.paths.concat()))?;
        let dispatch = kernel.prepare(&band, &paths, volumes, MapBuffer { buffer: &matches, layout });
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
        let dense = select(&self.paths, self.size, &config);
        let winners = path_winners(&self.paths, self.size, &config);
        let key = |winner: &Option<(u32, i32)>| {
            winner.map_or(u32::MAX, |(cost, disparity)| cost << 16 | (disparity - range.min) as u32)
        };
        Ok(Self::arrays(dense.disparity.into_data(), pack(&dense.confidence), winners.map(key).into_data()))
    }
}
