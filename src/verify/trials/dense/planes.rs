//! The planes that block matching compares: padding and soft ranks.

use crate::{
    cpu::dense::{pad, soft_rank},
    dense::{
        Brightness,
        kernels::{Pad, PadParams, SoftRank},
    },
    error::Result,
    gpu::uniform_buffer,
    image::{Luma, Size},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("pad", |size, dice| Box::new(PadTrial::draw(size, dice))),
    Subject::kernel("soft_rank", |size, dice| Box::new(SoftRankTrial::draw(size, dice))),
];

/// Draws a plane with `above` and `below` rows around a picture of this size.
fn padding(Size { width, height }: Size, [above, below]: [u32; 2], dice: &mut Dice) -> PadParams {
    PadParams {
        width,
        height,
        first_word: dice.between(-33, 5),
        first_row: -(above as i32),
        rows: above + height + below,
        stride: width.div_ceil(4) + dice.below(40) + 1,
        offset: dice.below(9),
    }
}

/// The plane of the twins as the kernels leave it: words in front of the plane are not written.
fn written(mut plane: Vec<u32>, params: &PadParams) -> Vec<Array> {
    plane[..params.offset as usize].fill(u32::MAX);
    vec![Array::exact("padded plane", plane)]
}

/// A picture to be padded.
#[derive(Clone, Debug)]
pub struct PadTrial {
    /// The picture, of the size given by the parameters.
    pub picture: Luma,
    /// Padding of the picture.
    pub params: PadParams,
    /// Change of brightness.
    pub brightness: Brightness,
}

impl PadTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let halo = [dice.below(20), dice.below(20)];
        let brightness = dice.pick(&[
            Brightness::SAME,
            Brightness { gain: 300, offset: -9000 },
            Brightness { gain: -40, offset: 60_000 },
        ]);
        let params = padding(size, halo, dice);
        Self { picture: dice.picture(size), params, brightness }
    }
}

impl Trial for PadTrial {
    fn parameters(&self) -> String {
        format!("{:?}, {:?}", self.params, self.brightness)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.picture.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, params) = (bench.gpu, self.params);
        let plane = bench.output(params.offset + params.rows * params.stride)?;
        let brightness = uniform_buffer(gpu, "brightness", &self.brightness);
        let pad = Pad::new(gpu).prepare(params, &brightness, &bench.upload_luma(&self.picture)?, &plane);
        bench.run(|encoder| pad.record(encoder));
        Ok(vec![Array::exact("padded plane", bench.download::<u32>(&plane)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(written(pad(&self.picture, &self.params, self.brightness), &self.params))
    }
}

/// A picture whose soft ranks are computed and padded.
#[derive(Clone, Debug)]
pub struct SoftRankTrial {
    /// The picture, of the size given by the parameters.
    pub picture: Luma,
    /// Padding of the soft ranks.
    pub params: PadParams,
}

impl SoftRankTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let halo = [dice.below(20), dice.below(20)];
        let (picture, grain) = (dice.picture(size), dice.pick(&[1, 8, 64]));
        Self { picture: picture.map(|&luma| luma / grain), params: padding(size, halo, dice) }
    }
}

impl Trial for SoftRankTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.params)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.picture.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let params = self.params;
        let plane = bench.output(params.offset + params.rows * params.stride)?;
        let ranks = SoftRank::new(bench.gpu).prepare(params, &bench.upload_luma(&self.picture)?, &plane);
        bench.run(|encoder| ranks.record(encoder));
        Ok(vec![Array::exact("padded plane", bench.download::<u32>(&plane)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(written(pad(&soft_rank(&self.picture), &self.params, Brightness::SAME), &self.params))
    }
}
