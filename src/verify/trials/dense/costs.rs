//! Matching costs: census transforms, the cost of each pixel and disparity, averaging.

use super::words::{bytes, words};
use crate::{
    cpu::dense::{Transforms, box_mean, census, cost, pad, wide_census},
    dense::{
        Brightness, Cost, Difference, View,
        kernels::{BoxMean, Census, CostVolume, LaneCost, PIXELS_HARDWARE, PIXELS_SOFTWARE, VolumeBand},
    },
    disparity::DisparityRange,
    error::Result,
    gpu::Windows,
    image::{Luma, Plane, Size},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("census", |size, dice| Box::new(CensusTrial::draw(size, dice, Windows::Rows))),
    Subject::kernel("tile_census", |size, dice| Box::new(CensusTrial::draw(size, dice, Windows::Tiles))),
    Subject::kernel("cost", |size, dice| Box::new(CostTrial::draw(size, dice, CostKernel::of_pixels))),
    Subject::kernel("lane_cost", |size, dice| Box::new(CostTrial::draw(size, dice, |_| CostKernel::Lanes))),
    Subject::kernel("box_mean", |size, dice| Box::new(BoxMeanTrial::draw(size, dice))),
];

/// A picture for the census transforms.
#[derive(Clone, Debug)]
pub struct CensusTrial {
    /// The picture.
    pub picture: Luma,
    /// Largest difference of the sums of weak texture; `None`: no wide census transforms.
    pub weak_spread: Option<u32>,
    /// Where threads keep their windows.
    pub windows: Windows,
}

impl CensusTrial {
    fn draw(size: Size, dice: &mut Dice, windows: Windows) -> Self {
        Self { picture: dice.picture(size), weak_spread: dice.coin().then(|| dice.pick(&[0, 130, 700, 2295])), windows }
    }
}

impl Trial for CensusTrial {
    fn parameters(&self) -> String {
        format!("weak spread {:?}", self.weak_spread)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.picture.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.picture.size();
        let plane = pad(&self.picture, &Census::padding(size, 0, size.height), Brightness::SAME);
        let transformed = bench.output(2 * size.width * size.height)?;
        let kernel = Census::new(bench.gpu, self.weak_spread, self.windows);
        let dispatch = kernel.prepare(size, &bench.upload(&plane)?, &transformed);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("census", bench.download::<u32>(&transformed)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let wide = self.weak_spread.map(|spread| wide_census(&self.picture, spread));
        Ok(vec![Array::exact("census", transforms(&Transforms { census: census(&self.picture), wide }))])
    }
}

/// Costs to be averaged.
#[derive(Clone, Debug)]
pub struct BoxMeanTrial {
    /// Size of the picture.
    pub size: Size,
    /// Costs of each pixel and disparity, padded to whole words per pixel.
    pub costs: Vec<u8>,
    /// Number of disparities.
    pub disparities: u32,
    /// Side of the window, in pixels.
    pub side: u32,
}

impl BoxMeanTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let disparities = dice.below(33) + 1;
        let row = size.width * DisparityRange::padded(disparities);
        let costs = dice.picture((row, size.height)).into_data();
        Self { size, costs, disparities, side: dice.pick(&[1, 3, 5, 7, 9, 31]) }
    }
}

impl Trial for BoxMeanTrial {
    fn parameters(&self) -> String {
        format!("{} disparities, side {}", self.disparities, self.side)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("costs", self.costs.clone())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height: rows }) = (bench.gpu, self.size);
        let band = VolumeBand { width, first_row: 0, rows, range: DisparityRange { min: 0, count: self.disparities } };
        let (costs, means) = (bench.upload(&words(&self.costs))?, bench.output(band.row_words() * rows)?);
        let dispatches = BoxMean::new(gpu, self.side).prepare(&band, 0..rows, &costs, &means);
        bench.run(|encoder| dispatches.iter().for_each(|dispatch| dispatch.record(encoder)));
        Ok(vec![Array::exact("means", bytes(&bench.download::<u32>(&costs)?))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("means", box_mean(&self.costs, self.size, self.side))])
    }
}

/// A kernel of the matching cost.
#[derive(Clone, Copy, Debug)]
pub enum CostKernel {
    /// [`CostVolume`], with so many pixels per thread.
    Pixels(u32),
    /// [`LaneCost`].
    Lanes,
}

impl CostKernel {
    fn of_pixels(dice: &mut Dice) -> Self {
        Self::Pixels(dice.pick(&[PIXELS_SOFTWARE, PIXELS_HARDWARE]))
    }
}

/// Two census transforms whose pixels are compared.
#[derive(Clone, Debug)]
pub struct CostTrial {
    /// Census transforms of the reference and of the other view.
    pub views: [Transforms; 2],
    /// The reference view.
    pub view: View,
    /// The matching cost.
    pub cost: Cost,
    /// The disparities.
    pub range: DisparityRange,
    /// The rows whose costs are computed.
    pub rows: std::ops::Range<u32>,
    /// By which kernel.
    pub by: CostKernel,
}

impl CostTrial {
    fn draw(size: Size, dice: &mut Dice, by: fn(&mut Dice) -> CostKernel) -> Self {
        let mut part = || Difference { weight: dice.below(40), limit: dice.below(60) };
        let (difference, gradient) = (part(), part());
        let census_weight = dice.pick(&[0, 20, 40, 255]);
        let (view, mut range) = (dice.view(), dice.range(70));
        range.min += dice.pick(&[0, 0, 9, -500, 90]);
        let first = dice.below(size.height.min(4));
        let pair = dice.pair(size);
        let rows = first..size.height - dice.below(size.height - first);
        let weak_spread = weak_spread(dice);
        let cost = Cost { census: census_weight, difference, gradient, weak_spread };
        Self { views: pair.map(|luma| Transforms::new(&luma, &cost)), view, cost, range, rows, by: by(dice) }
    }
}

impl Trial for CostTrial {
    fn parameters(&self) -> String {
        format!("{:?} {:?} {:?} rows {:?} by {:?}", self.view, self.cost, self.range, self.rows, self.by)
    }

    fn input(&self) -> Vec<Array> {
        let [reference, other] = self.views.each_ref().map(transforms);
        vec![Array::exact("reference", reference), Array::exact("other", other)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Self { views: [reference, other], range, rows, .. } = self;
        let Size { width, .. } = reference.census.size();
        let band = VolumeBand { width, first_row: rows.start, rows: rows.len() as u32, range: *range };
        let volume = bench.output(band.row_words() * band.rows)?;
        let views = [&bench.upload(&transforms(reference))?, &bench.upload(&transforms(other))?];
        let dispatch = match self.by {
            CostKernel::Pixels(pixels) => {
                CostVolume::new(bench.gpu, &self.cost, self.view, pixels).prepare(&band, views, &volume)
            }
            CostKernel::Lanes => LaneCost::new(bench.gpu, &self.cost, self.view).prepare(&band, views, &volume),
        };
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("costs", bytes(&bench.download(&volume)?))])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Self { views: [reference, other], range, rows, .. } = self;
        let costs = cost([reference, other], self.view, &self.cost, *range);
        let row = costs.len() / reference.census.height() as usize;
        Ok(vec![Array::exact("costs", costs[rows.start as usize * row..rows.end as usize * row].to_vec())])
    }
}

pub(super) fn weak_spread(dice: &mut Dice) -> Option<u32> {
    dice.coin().then(|| dice.pick(&[60, 200, 700]))
}

/// The census transforms of a view as the kernels write them.
pub(super) fn transforms(Transforms { census, wide }: &Transforms) -> Vec<u32> {
    let wide = wide.iter().flat_map(|wide| wide.data()).copied().chain(std::iter::repeat(0));
    census.data().iter().copied().zip(wide).flat_map(<[u32; 2]>::from).collect()
}

/// Words whose lowest byte is the luma of a pixel, as the census transforms of a view.
pub(super) fn lumas(words: &Plane<u32>) -> Vec<u32> {
    words.data().iter().flat_map(|&word| [word, u32::MAX]).collect()
}
