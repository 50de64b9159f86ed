//! Filling of holes: projection to the other view, bitmaps, tangent planes, rays.

use super::{
    blocks::signed,
    maps::{arrays, matches},
};
use crate::{
    cpu::dense::{Surroundings, Tangent, bitmaps, fill, project, tangents},
    dense::{
        Dense, FILLED, View,
        kernels::{self, Bitmaps, Fill, MapBuffer, MapLayout, Project, Shown, Tangents, fit},
    },
    disparity::{DisparityMap, DisparityRange, NONE},
    error::Result,
    image::{Luma, Plane, Size},
    luma::pack,
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("project", |size, dice| Box::new(ProjectTrial::draw(size, dice))),
    Subject::kernel("bitmap", |size, dice| Box::new(BitmapTrial::draw(size, dice))),
    Subject::kernel("tangent", |size, dice| Box::new(TangentTrial::draw(size, dice))),
    Subject::kernel("fill", |size, dice| Box::new(FillTrial::draw(size, dice))),
];

/// Draws slanted surfaces with noise, of all lengths, and with holes of all sizes.
fn surfaces(Size { width, height }: Size, dice: &mut Dice) -> DisparityMap {
    let [coarse, gaps] = [40, 9].map(|side| dice.picture((width.div_ceil(side), height.div_ceil(side))));
    let (holes, dots, noise) = (dice.pick(&[0, 90, 200, 255]), dice.pick(&[0, 20, 250]), 1 + dice.below(100));
    let [across, down] = [70, 150].map(|most| dice.between(-most, most));
    Plane::from_fn((width, height), |x, y| {
        if gaps.get(x / 9, y / 9) < holes || dice.below(256) < dots {
            return NONE;
        }
        let level = i32::from(coarse.get(x / 40, y / 40)) * 40 - 3000;
        level + across * (x as i32 % 256) + down * (y as i32 % 256) + dice.below(noise) as i32
    })
}

/// Draws a picture in colour.
fn picture(size: Size, dice: &mut Dice) -> Plane<[u8; 4]> {
    let channels = [0; 4].map(|_| dice.picture(size));
    Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y)))
}

/// Draws a mask.
fn mask(size: Size, dice: &mut Dice) -> Luma {
    dice.picture(size).map(|&value| if value < 90 { 0 } else { value })
}

/// Draws a range of disparities.
fn range(dice: &mut Dice) -> DisparityRange {
    DisparityRange { min: dice.between(-20, 0), count: 1 + dice.below(60) }
}

/// The words of projected disparities.
fn projected_words(projected: &DisparityMap) -> Vec<u32> {
    projected.data().iter().map(|disparity| disparity.cast_unsigned() ^ 1 << 31).collect()
}

/// The words of tangent planes, height, slopes and colour each; 0 where there is none.
fn tangent_words(tangents: &Plane<Option<Tangent>>) -> Vec<u32> {
    let slopes = |[x, y]: [i32; 2]| x.cast_unsigned() & 0xffff | y.cast_unsigned() << 16;
    let colour = |[red, green, blue]: [u8; 3]| u32::from_le_bytes([red, green, blue, 0]);
    let words = |plane: &Option<Tangent>| {
        let mark = |plane: &Tangent| {
            let of = |is_marked: bool, mark: u32| if is_marked { mark } else { 0 };
            of(plane.is_small, fit::SMALL) | of(plane.is_doubtful, fit::DOUBTFUL)
        };
        plane.map_or([0; 3], |plane| {
            [plane.height.cast_unsigned(), slopes(plane.slopes), colour(plane.colour) | mark(&plane)]
        })
    };
    tangents.data().iter().flat_map(words).collect()
}

/// The words of a picture.
fn picture_words(picture: &Plane<[u8; 4]>) -> Vec<u32> {
    picture.data().iter().map(|&pixel| u32::from_le_bytes(pixel)).collect()
}

/// A map to be projected to the other view.
#[derive(Clone, Debug)]
pub struct ProjectTrial {
    /// The map.
    pub disparities: DisparityMap,
    /// The view of the map.
    pub view: View,
}

impl ProjectTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { disparities: surfaces(size, dice), view: dice.view() }
    }
}

impl Trial for ProjectTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.view)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("disparities", self.disparities.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.disparities.size();
        let (from, to) = (bench.upload(self.disparities.data())?, bench.output(size.pixels() as u32)?);
        let dispatch = Project::new(bench.gpu).prepare(size, self.view, &from, &to);
        bench.run(|encoder| {
            encoder.clear_buffer(&to, 0, None);
            dispatch.record(encoder);
        });
        Ok(vec![Array::exact("projected", bench.download::<u32>(&to)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("projected", projected_words(&project(&self.disparities, self.view)))])
    }
}

/// A map of which bitmaps are made.
#[derive(Clone, Debug)]
pub struct BitmapTrial {
    /// The map.
    pub disparities: DisparityMap,
    /// The mask of the view, if it hides pixels, and its row of the first row of the map.
    pub shown: Option<(Luma, u32)>,
}

impl BitmapTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (disparities, first_row) = (surfaces(size, dice), dice.below(3));
        let mask = mask(Size::new(size.width, size.height + first_row), dice);
        Self { disparities, shown: (dice.below(2) == 0).then_some((mask, first_row)) }
    }
}

impl Trial for BitmapTrial {
    fn parameters(&self) -> String {
        self.shown.as_ref().map(|(_, first_row)| format!("masked from row {first_row} on")).unwrap_or_default()
    }

    fn input(&self) -> Vec<Array> {
        let mask = self.shown.iter().map(|(mask, _)| Array::exact("mask", mask.data().to_vec()));
        std::iter::once(Array::exact("disparities", self.disparities.data().to_vec())).chain(mask).collect()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.disparities.size();
        let (from, to) = (bench.upload_words(self.disparities.data())?, bench.output(Bitmaps::words(size) as u32)?);
        let mask = bench.upload(&self.shown.as_ref().map_or(vec![0], |(mask, _)| pack(mask)))?;
        let first_row = self.shown.as_ref().map_or(0, |(_, first_row)| *first_row);
        let shown = Shown { mask: &mask, first_row, is_masked: self.shown.is_some() };
        let dispatch = Bitmaps::new(bench.gpu).prepare(size, &from, shown, &to);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("bitmaps", bench.download::<u32>(&to)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let own = self.shown.as_ref().map(|(mask, first_row)| mask.cut(*first_row..mask.height()));
        Ok(vec![Array::exact("bitmaps", bitmaps(&self.disparities, own.as_ref()))])
    }
}

/// A map whose surfaces end at holes.
#[derive(Clone, Debug)]
pub struct TangentTrial {
    /// The map.
    pub disparities: DisparityMap,
    /// Colours of its view.
    pub picture: Plane<[u8; 4]>,
    /// The range that was searched.
    pub range: DisparityRange,
}

impl TangentTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { disparities: surfaces(size, dice), picture: picture(size, dice), range: range(dice) }
    }
}

impl Trial for TangentTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.range)
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("disparities", self.disparities.data().to_vec()),
            Array::exact("picture", self.picture.data().as_flattened().to_vec()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.disparities.size();
        let (from, marks) =
            (bench.upload_words(self.disparities.data())?, bench.upload(&bitmaps(&self.disparities, None))?);
        // Pixels beside no hole stay as they are, and so does the picture.
        let before = vec![0; 3 * size.pixels() as usize];
        let to = bench.upload(&[before, picture_words(&self.picture)].concat())?;
        let dispatch = Tangents::new(bench.gpu).prepare(size, self.range, &from, &marks, &to);
        bench.run(|encoder| dispatch.record(encoder));
        let words = bench.download::<u32>(&to)?;
        Ok(tangent_arrays(&words[..3 * size.pixels() as usize]))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(tangent_arrays(&tangent_words(&tangents(&self.disparities, &self.picture, self.range))))
    }
}

fn tangent_arrays(words: &[u32]) -> Vec<Array> {
    let part = |first: usize| words.iter().skip(first).step_by(3).copied().collect::<Vec<_>>();
    vec![Array::exact("heights", signed(&part(0))), Array::exact("slopes", part(1)), Array::exact("colours", part(2))]
}

/// A map whose holes are filled.
#[derive(Clone, Debug)]
pub struct FillTrial {
    /// The map.
    pub dense: Dense,
    /// Colours of its view.
    pub picture: Plane<[u8; 4]>,
    /// The view of the map.
    pub view: View,
    /// Range of the filled disparities.
    pub range: DisparityRange,
    /// The mask of the view, if it hides pixels: these stay holes.
    pub own: Option<Luma>,
}

impl FillTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let disparity = surfaces(size, dice);
        let measured = u32::from(u8::MAX - FILLED);
        let confidence = disparity.map(|&d| if d == NONE { 0 } else { FILLED + 1 + dice.below(measured) as u8 });
        let (range, picture, view, own) = (range(dice), picture(size, dice), dice.view(), mask(size, dice));
        let own = (dice.below(4) > 0).then_some(own);
        Self { dense: Dense { disparity, confidence }, picture, view, range, own }
    }

    fn surroundings(&self) -> Surroundings<'_> {
        Surroundings::new(&self.dense.disparity, self.view, self.range, &self.picture)
    }
}

impl Trial for FillTrial {
    fn parameters(&self) -> String {
        format!("{:?}, {:?}", self.view, self.range)
    }

    fn input(&self) -> Vec<Array> {
        let mask = self.own.iter().map(|mask| Array::exact("mask", mask.data().to_vec()));
        let picture = Array::exact("picture", self.picture.data().as_flattened().to_vec());
        [Array::exact("matches", matches(&self.dense)), picture].into_iter().chain(mask).collect()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.dense.disparity.size();
        let layout = MapLayout { width: size.width, rows: size.height };
        let Surroundings { picture, tangents, projected } = self.surroundings();
        let words = matches(&self.dense);
        let tangents = bench.upload(&[tangent_words(&tangents), picture_words(picture)].concat())?;
        let projected = bench.upload(&projected_words(&projected))?;
        let bitmaps = bench.upload(&bitmaps(&self.dense.disparity, self.own.as_ref()))?;
        let buffer = bench.upload(&words)?;
        let surroundings = kernels::Surroundings { tangents: &tangents, projected: &projected, bitmaps: &bitmaps };
        let map = MapBuffer { buffer: &buffer, layout };
        let dispatch = Fill::new(bench.gpu).prepare(self.range, self.view, surroundings, map, 0..size.height);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&buffer)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let filled = fill(&self.dense, &self.surroundings(), self.own.as_ref(), self.view, self.range);
        Ok(arrays(&matches(&filled), filled.disparity.data().len()))
    }
}
