//! The integral image.

use crate::{
    cpu::features::{integral_columns::integral_columns, integral_rows::integral_rows},
    error::Result,
    features::kernels::{integral_columns::IntegralColumns, integral_rows::IntegralRows},
    image::{Luma, Plane, Size},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("integral_rows", |size, dice| Box::new(RowsTrial::draw(size, dice))),
    Subject::kernel("integral_columns", |size, dice| Box::new(ColumnsTrial::draw(size, dice))),
];

/// A picture to be summed along rows.
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
        let sums = bench.output((IntegralRows::bytes(self.0.size()) / 4) as u32)?;
        let dispatch = IntegralRows::new(bench.gpu).prepare(self.0.size(), &bench.upload_luma(&self.0)?, &sums);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("sums", bench.download::<u32>(&sums)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("sums", integral_rows(&self.0).into_data())])
    }
}

/// Row sums, one column and one row more than a picture has, to be summed along columns.
#[derive(Clone, Debug)]
pub struct ColumnsTrial(pub Plane<u32>);

impl ColumnsTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let sums = integral_rows(&dice.picture(size));
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
        let size = Size::new(self.0.width() - 1, self.0.height() - 1);
        let dispatch = IntegralColumns::new(bench.gpu).prepare(size, &sums);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("integral image", bench.download::<u32>(&sums)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let mut sums = self.0.clone();
        integral_columns(&mut sums);
        Ok(vec![Array::exact("integral image", sums.into_data())])
    }
}
