//! Dense matching by each preset, from two views to a map.

use crate::{
    config::Preset,
    cpu::dense::{self as twins, compute},
    dense::{Brightness, Dense, DenseConfig, Matcher, Pyramid, Seen, compute_over, kernels::Loss},
    disparity::DisparityRange,
    error::Result,
    gpu::block_on,
    image::{Luma, Size},
    luma::pack,
    verify::{
        dice::smooth_noise,
        trial::{Array, Bench, Dice, Subject, Trial},
    },
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::pipeline("fast", |size, dice| Box::new(DenseTrial::of_preset(Preset::Fast, size, dice))),
    Subject::pipeline("balanced", |size, dice| Box::new(DenseTrial::of_preset(Preset::Balanced, size, dice))),
    Subject::pipeline("quality", |size, dice| Box::new(DenseTrial::of_preset(Preset::Quality, size, dice))),
    Subject::pipeline("pyramid", |size, dice| Box::new(PyramidTrial::draw(size, dice))),
    Subject::pipeline("paper", |size, dice| Box::new(DenseTrial::of_preset(Preset::Paper, size, dice))),
];

/// A pair to be matched.
#[derive(Clone, Debug)]
pub struct DenseTrial {
    /// The left view.
    pub left: Luma,
    /// The right view.
    pub right: Luma,
    /// Parameters of the matching.
    pub config: DenseConfig,
    /// Most rows of a band.
    pub band_rows: u32,
}

impl DenseTrial {
    fn of_preset(preset: Preset, size: Size, dice: &mut Dice) -> Self {
        let view = dice.view();
        let banded = dice.below(3) == 0;
        let brightness = dice.pick(&[Brightness::SAME, Brightness { gain: 280, offset: -700 }]);
        let reference = if preset == Preset::Paper { preset.config().reference } else { view };
        let band_rows = if banded { 1 + dice.below(size.height) } else { u32::MAX };
        let (range, [left, right]) = uneven(size, dice);
        Self { left, right, config: DenseConfig { reference, brightness, ..preset.dense_config(range) }, band_rows }
    }

    fn arrays(dense: Dense) -> Vec<Array> {
        vec![
            Array::exact("disparities", dense.disparity.into_data()),
            Array::exact("confidences", dense.confidence.into_data()),
        ]
    }
}

/// Draws a pair whose disparities cross the range from left to right, up and down, in increasing noise, so that every
/// penalty and every check decides some pixels.
fn uneven(Size { width, height }: Size, dice: &mut Dice) -> (DisparityRange, [Luma; 2]) {
    // In a picture of one column only disparity 0 has a partner.
    let min = dice.between(-6, 1).min(width as i32 - 1);
    let range = DisparityRange { min, count: 24 + dice.below(25) };
    let [right, relief, grain] = [0; 3].map(|_| dice.word());
    let right = smooth_noise((width, height), right);
    let relief = smooth_noise((width / 8 + 1, height / 8 + 1), relief);
    let grain = smooth_noise((8 * width, height), grain);
    let left = Luma::from_fn((width, height), |x, y| {
        let quarters = 3 * x * range.count / width + u32::from(relief.get(x / 8, y / 8)) * range.count / 256;
        let disparity = range.min + (quarters / 4) as i32;
        let noise = i64::from(grain.get(8 * x, y)) - 128;
        let value = i64::from(right.get_clamped(i64::from(x) - i64::from(disparity), i64::from(y)));
        (value + noise * i64::from(x) / (6 * i64::from(width))).clamp(0, 255) as u8
    });
    (range, [left, right])
}

impl Trial for DenseTrial {
    fn parameters(&self) -> String {
        format!("{:?} in bands of at most {} rows", self.config, self.band_rows)
    }

    fn input(&self) -> Vec<Array> {
        let view = |name, view: &Luma| Array::exact(name, view.data().to_vec());
        vec![view("left", &self.left), view("right", &self.right)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let matcher = block_on(Matcher::with_band_rows(bench.gpu, self.left.size(), &self.config, self.band_rows))?;
        for (view, luma) in [&self.left, &self.right].into_iter().zip(matcher.luma()) {
            bench.write(luma, &pack(view));
        }
        Ok(Self::arrays(matcher.run()?))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(Self::arrays(compute(&self.left, &self.right, &self.config)?))
    }
}

/// A pair to be matched over a pyramid.
#[derive(Clone, Debug)]
pub struct PyramidTrial {
    /// The pair.
    pub dense: DenseTrial,
    /// The levels.
    pub pyramid: Pyramid,
    /// Masks of the reference view and of the other one, and what a pixel with a hidden partner loses, if anything is hidden.
    pub hidden: Option<([Luma; 2], Loss)>,
}

impl PyramidTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let preset = dice.pick(&[Preset::Balanced, Preset::Quality]);
        let dense = DenseTrial::of_preset(preset, size, dice);
        // Verified by the CPU: the range has a disparity that gives a pixel a partner.
        let range = dense.config.searched(size.width).unwrap_or(dense.config.range);
        let pyramid = Pyramid::down_to(dice.pick(&[20, 60]), size, range);
        // Parts that levels of half and a quarter of the size hide as a whole, too.
        let mut mask = || {
            let parts = smooth_noise((size.width / 12 + 1, size.height / 12 + 1), dice.word());
            Luma::from_fn(size, |x, y| if parts.get(x / 12, y / 12) < 80 { 0 } else { 255 })
        };
        let masks = [mask(), mask()];
        let hidden = (dice.below(2) == 0).then(|| (masks, dice.pick(&Loss::ALL)));
        Self { dense, pyramid, hidden }
    }

    fn seen(&self) -> Option<Seen<'_>> {
        self.hidden.as_ref().map(|(masks, loss)| Seen { masks: masks.each_ref().map(Some), loss: *loss })
    }
}

impl Trial for PyramidTrial {
    fn parameters(&self) -> String {
        let hidden = self.hidden.as_ref().map_or(String::new(), |(_, loss)| format!(", masked, {loss:?} lost"));
        format!("{} levels{hidden}, {}", self.pyramid.levels().len(), self.dense.parameters())
    }

    fn input(&self) -> Vec<Array> {
        let mask = |(name, mask): (&'static str, &Luma)| Array::exact(name, mask.data().to_vec());
        let masks =
            self.hidden.iter().flat_map(|(masks, _)| ["own mask", "other mask"].into_iter().zip(masks)).map(mask);
        self.dense.input().into_iter().chain(masks).collect()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Self { dense: DenseTrial { left, right, config, band_rows }, pyramid, .. } = self;
        let dense = block_on(compute_over(bench.gpu, [left, right], self.seen(), config, pyramid, *band_rows))?;
        Ok(DenseTrial::arrays(dense))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Self { dense: DenseTrial { left, right, config, .. }, pyramid, .. } = self;
        Ok(DenseTrial::arrays(twins::compute_over([left, right], self.seen(), config, Some(pyramid))?))
    }
}
