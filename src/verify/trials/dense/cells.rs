//! Coarse to fine: downscaling to half the size, and the ranges of cells.

use super::blocks::cell_words;
use crate::{
    cpu::dense::{cell_ranges, halve},
    dense::kernels::{CellBand, CellRanges, Halve},
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    error::Result,
    image::{Luma, Plane, Size},
    luma::pack,
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("halve", |size, dice| Box::new(HalveTrial(dice.picture(size)))),
    Subject::kernel("cell_ranges", |size, dice| Box::new(CellRangesTrial::draw(size, dice))),
];

/// A picture to be downscaled.
#[derive(Clone, Debug)]
pub struct HalveTrial(pub Luma);

impl Trial for HalveTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.0.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height }) = (bench.gpu, self.0.size());
        let halved = bench.output(width.div_ceil(2).div_ceil(4) * height.div_ceil(2))?;
        let dispatch = Halve::new(gpu).prepare(Size::new(width, height), &bench.upload_luma(&self.0)?, &halved);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("half the picture", bench.download::<u32>(&halved)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("half the picture", pack(&halve(&self.0)))])
    }
}

/// A half-size map, for a picture of `size`.
#[derive(Clone, Debug)]
pub struct CellRangesTrial {
    /// Size of the picture.
    pub size: Size,
    /// Half-size map.
    pub map: DisparityMap,
    /// The searched disparities, of which each cell gets a part.
    pub range: DisparityRange,
}

impl CellRangesTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let range = dice.pick(&[(0, 64), (-9, 33), (5, 1), (-3000, 6001)]);
        let range = DisparityRange { min: range.0, count: range.1 };
        let half = (size.width.div_ceil(2), size.height.div_ceil(2));
        let (steps, holes) = (dice.picture(half), dice.picture(half));
        let map = Plane::from_fn(half, |x, y| {
            let share = i64::from(steps.get(x, y)) * i64::from(range.count) * i64::from(SCALE) / 512;
            // Holes become denser to the right.
            let hole = u32::from(holes.get(x, y)) < x * 300 / half.0;
            if hole { NONE } else { range.min * SCALE / 2 + share as i32 }
        });
        Self { size, map, range }
    }
}

impl Trial for CellRangesTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.range)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("map of half the size", self.map.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let band = CellBand::new(self.size, (0, self.size.height), self.range);
        let ranges = bench.output(band.words() as u32)?;
        let dispatch = CellRanges::new(bench.gpu).prepare(&band, &bench.upload(self.map.data())?, &ranges);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("ranges", bench.download::<u32>(&ranges)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("ranges", cell_words(&cell_ranges(&self.map, self.size, self.range)))])
    }
}
