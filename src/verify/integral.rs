//! Colour to luma, and the integral image.

use super::{
    array::Array,
    bench::Bench,
    case::{Subject, Trial},
    dice::{Dice, Size},
};
use crate::{
    error::Result,
    features::{integral_columns::IntegralColumns, integral_rows::IntegralRows},
    image::{Luma, Plane},
    luma::{RgbaToLuma, pack},
    reference::{integral_columns::sum_columns, integral_rows::sum_rows, luma::from_rgba},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("luma", |size, dice| Box::new(LumaTrial::draw(size, dice))),
    Subject::kernel("integral_rows", |size, dice| Box::new(RowsTrial::draw(size, dice))),
    Subject::kernel("integral_columns", |size, dice| Box::new(ColumnsTrial::draw(size, dice))),
];

/// A picture in colour, to become luma.
#[derive(Clone, Debug)]
pub struct LumaTrial(pub Plane<[u8; 4]>);

impl LumaTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let channels = [0; 4].map(|_| dice.picture(size));
        Self(Plane::from_fn(size.0, size.1, |x, y| channels.each_ref().map(|channel| channel.get(x, y))))
    }
}

impl Trial for LumaTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("rgba", self.0.data().as_flattened().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (width, height) = self.0.size();
        let stage = RgbaToLuma::new(bench.device(), &bench.upload(self.0.data())?, width, height)?;
        bench.poison(stage.luma());
        bench.run(|encoder| stage.record(encoder));
        Ok(vec![Array::exact("luma", bench.download::<u32>(stage.luma())?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let (width, height) = self.0.size();
        let luma = from_rgba(width, height, self.0.data().as_flattened())?;
        Ok(vec![Array::exact("luma", pack(&luma))])
    }
}

/// A picture whose rows are summed.
#[derive(Clone, Debug)]
pub struct RowsTrial(pub Luma);

impl RowsTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self(dice.picture(size))
    }
}

impl Trial for RowsTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.0.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (width, height) = self.0.size();
        let stage = IntegralRows::new(bench.device(), &bench.upload_luma(&self.0)?, width, height)?;
        bench.poison(stage.sums());
        bench.run(|encoder| stage.record(encoder));
        Ok(vec![Array::exact("sums", bench.download::<u32>(stage.sums())?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("sums", sum_rows(&self.0).into_data())])
    }
}

/// Sums of rows, a column and a row more than a picture has, whose columns are summed.
#[derive(Clone, Debug)]
pub struct ColumnsTrial(pub Plane<u32>);

impl ColumnsTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let sums = sum_rows(&dice.picture(size));
        // Sums that wrap, as in a picture of many megapixels.
        let large = if dice.coin() { u32::MAX >> dice.below(8) } else { 0 };
        Self(sums.map(|&sum| sum.wrapping_add(large)))
    }
}

impl Trial for ColumnsTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("sums", self.0.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let sums = bench.upload(self.0.data())?;
        let stage = IntegralColumns::new(bench.device(), &sums, self.0.width() - 1, self.0.height() - 1);
        bench.run(|encoder| stage.record(encoder));
        Ok(vec![Array::exact("integral image", bench.download::<u32>(&sums)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let mut sums = self.0.clone();
        sum_columns(&mut sums);
        Ok(vec![Array::exact("integral image", sums.into_data())])
    }
}
