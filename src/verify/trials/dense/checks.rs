//! Checks of a map: consistency with the other view, agreement of neighbours, and what does not show the scene.

use super::maps::{arrays, dense, map, matches};
use crate::{
    cpu::dense::{agreement, consistency, unseen},
    dense::{
        Dense, View,
        kernels::{Agreement, CheckedAgainst, Consistency, Loss, MapBuffer, MapLayout, Unseen},
    },
    disparity::{DisparityMap, NONE, SCALE},
    error::Result,
    image::{Luma, Size},
    luma::pack,
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("consistency", |size, dice| Box::new(ConsistencyTrial::draw(size, dice))),
    Subject::kernel("agreement", |size, dice| Box::new(AgreementTrial::draw(size, dice))),
    Subject::kernel("unseen", |size, dice| Box::new(UnseenTrial::draw(size, dice))),
];

/// Two maps to be compared.
#[derive(Clone, Debug)]
pub struct ConsistencyTrial {
    /// Map of the reference view.
    pub dense: Dense,
    /// The reference view.
    pub view: View,
    /// Map of the other view.
    pub others: DisparityMap,
    /// Disparity of index 0, in pixels, if the other view's disparities are claims, which are whole pixels.
    pub claims_from: Option<i32>,
    /// Largest accepted difference, in 1/256 px.
    pub max_difference: u32,
}

impl ConsistencyTrial {
    /// The other view's disparities as the kernel reads them.
    fn words(&self) -> Vec<u32> {
        let word = |disparity: i32| match self.claims_from {
            None => disparity.cast_unsigned(),
            Some(_) if disparity == NONE => 0,
            // The cost is arbitrary.
            Some(least) => !(77 << 16 | (disparity / SCALE - least) as u32),
        };
        self.others.data().iter().map(|&disparity| word(disparity)).collect()
    }
}

impl ConsistencyTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (view, max_difference) = (dice.view(), dice.pick(&[0, 100, 256, 2000, 65536]));
        let claims_from = dice.coin().then_some(-30);
        let others = map(size, dice, -30 * SCALE, 60 * SCALE);
        let whole = |&disparity: &i32| if disparity == NONE { NONE } else { disparity.div_euclid(SCALE) * SCALE };
        let others = if claims_from.is_some() { others.map(whole) } else { others };
        Self { dense: dense(size, dice), view, others, claims_from, max_difference }
    }
}

impl Trial for ConsistencyTrial {
    fn parameters(&self) -> String {
        let Self { view, claims_from, max_difference, .. } = self;
        format!("{view:?}, claims from {claims_from:?}, at most {max_difference}")
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("matches", matches(&self.dense)), Array::exact("others", self.words())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.dense.disparity.size());
        let layout = MapLayout { width: size.width, rows: size.height };
        let (others, matches) = (bench.upload(&self.words())?, bench.upload(&matches(&self.dense))?);
        let kernel =
            Consistency::new(gpu, self.claims_from.map_or(CheckedAgainst::Disparities, CheckedAgainst::Claims));
        let dispatch = kernel.prepare(
            MapBuffer { buffer: &matches, layout },
            size.height,
            self.view,
            self.max_difference,
            &others,
        );
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&matches)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let mut dense = self.dense.clone();
        consistency(&mut dense, self.view, &self.others, self.max_difference);
        Ok(arrays(&matches(&dense), dense.disparity.data().len()))
    }
}

/// A map whose neighbours are asked.
#[derive(Clone, Debug)]
pub struct AgreementTrial {
    /// The map.
    pub dense: Dense,
    /// Agreeing pixels of nine, at least.
    pub least: u32,
}

impl AgreementTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let least = dice.pick(&[0, 1, 3, 6, 9]);
        Self { dense: dense(size, dice), least }
    }
}

impl Trial for AgreementTrial {
    fn parameters(&self) -> String {
        format!("at least {}", self.least)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("matches", matches(&self.dense))]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.dense.disparity.size();
        let layout = MapLayout { width, rows: height };
        let before = matches(&self.dense);
        let (words, matches) = (bench.upload_words(&before)?, bench.upload(&before)?);
        let dispatch = Agreement::new(bench.gpu).prepare(&words, self.least, MapBuffer { buffer: &matches, layout });
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&matches)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let mut dense = self.dense.clone();
        agreement(&mut dense, self.least);
        Ok(arrays(&matches(&dense), dense.disparity.data().len()))
    }
}

/// A map, and what the masks of both views hide.
#[derive(Clone, Debug)]
pub struct UnseenTrial {
    /// The map.
    pub dense: Dense,
    /// The reference view.
    pub view: View,
    /// Masks of the reference view and of the other one, 0 for a hidden pixel.
    pub masks: [Luma; 2],
    /// Row of the masks of the first row of the map.
    pub first_row: u32,
    /// What a pixel with a hidden partner loses.
    pub loss: Loss,
}

impl UnseenTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let first_row = dice.below(5);
        let size_of_masks = Size::new(size.width, size.height + first_row);
        let mut mask = || dice.picture(size_of_masks).map(|&value| if value < 90 { 0 } else { value });
        let masks = [mask(), mask()];
        let (view, loss) = (dice.view(), dice.pick(&Loss::ALL));
        Self { dense: dense(size, dice), view, masks, first_row, loss }
    }
}

impl Trial for UnseenTrial {
    fn parameters(&self) -> String {
        let Self { view, first_row, loss, .. } = self;
        format!("{view:?}, from row {first_row}, loss of {loss:?}")
    }

    fn input(&self) -> Vec<Array> {
        let [own, other] = self.masks.each_ref().map(pack);
        vec![Array::exact("matches", matches(&self.dense)), Array::exact("own", own), Array::exact("other", other)]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.dense.disparity.size();
        let layout = MapLayout { width, rows: height };
        let matches = bench.upload(&matches(&self.dense))?;
        let [own, other] = self.masks.each_ref().map(|mask| bench.upload(&pack(mask)));
        let map = MapBuffer { buffer: &matches, layout };
        let dispatch = Unseen::new(bench.gpu).prepare(map, self.first_row, self.view, [&own?, &other?], self.loss);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&matches)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let mut dense = self.dense.clone();
        let end = self.first_row + dense.disparity.height();
        let [own, other] = self.masks.each_ref().map(|mask| mask.cut(self.first_row..end));
        unseen(&mut dense, self.view, Some(&own), Some(&other), self.loss);
        Ok(arrays(&matches(&dense), dense.disparity.data().len()))
    }
}
