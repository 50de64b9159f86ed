//! Map kernels: residuals, support, medians, textures.

use super::blocks::signed;
use crate::{
    cpu::dense::{map_back, map_texture, residual, support, weighted_median},
    dense::{
        Brightness, Dense, Median, View,
        kernels::{
            ComparedViews, MAX_RESIDUAL, MapBack, MapBuffer, MapLayout, MapRows, MapTexel, MapTexture, Residual,
            Support, WeightedMedian,
        },
    },
    disparity::{DisparityMap, NONE, SCALE},
    error::Result,
    gpu::{Windows, uniform_buffer},
    image::{Luma, Plane, Size},
    luma::pack,
    rectify::WarpMap,
    verify::trial::{Array, Bench, Dice, Subject, Trial},
    verify::trials::rectify::{map as warp_map, source_size},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("residual", |size, dice| Box::new(ResidualTrial::draw(size, dice))),
    Subject::kernel("support", |size, dice| Box::new(SupportTrial::draw(size, dice, Windows::Rows))),
    Subject::kernel("tile_support", |size, dice| Box::new(SupportTrial::draw(size, dice, Windows::Tiles))),
    Subject::kernel("map_texture", |size, dice| Box::new(MapTextureTrial::draw(size, dice))),
    Subject::kernel("map_back", |size, dice| Box::new(MapBackTrial::draw(size, dice))),
    Subject::kernel("weighted_median", |size, dice| Box::new(MedianTrial::draw(size, dice, Windows::Rows))),
    Subject::kernel("tile_weighted_median", |size, dice| Box::new(MedianTrial::draw(size, dice, Windows::Tiles))),
];

/// Draws a map of all kinds of disparities, in 1/256 px: smooth, noisy, none, from `least` to `most` and possibly
/// beyond.
pub(super) fn map(Size { width, height }: Size, dice: &mut Dice, least: i32, most: i32) -> DisparityMap {
    let surface = dice.picture((width, height));
    let (holes, noise) = (dice.pick(&[0, 30, 128, 250]), 1 + dice.below(300));
    Plane::from_fn((width, height), |x, y| {
        let smooth = least + (most - least) / 256 * i32::from(surface.get(x, y));
        if dice.below(256) < holes { NONE } else { smooth + dice.below(noise) as i32 }
    })
}

/// Draws a map with confidences, 0 where there is no disparity.
pub(super) fn dense(size: Size, dice: &mut Dice) -> Dense {
    let disparity = map(size, dice, -30 * SCALE, 60 * SCALE);
    let confidence = disparity.map(|&disparity| if disparity == NONE { 0 } else { 1 + dice.below(255) as u8 });
    Dense { disparity, confidence }
}

/// A map and its confidences in one buffer, in the layout of the kernels.
pub(super) fn matches(dense: &Dense) -> Vec<u32> {
    let mut words: Vec<u32> = dense.disparity.data().iter().map(|disparity| disparity.cast_unsigned()).collect();
    words.extend(pack(&dense.confidence));
    words
}

pub(super) fn arrays(matches: &[u32], pixels: usize) -> Vec<Array> {
    let (disparities, confidences) = matches.split_at(pixels);
    vec![Array::exact("disparities", signed(disparities)), Array::exact("confidences", confidences.to_vec())]
}

/// Two views to be compared at the disparities of one.
#[derive(Clone, Debug)]
pub struct ResidualTrial {
    /// Left and right view; they can have more rows than the map.
    pub views: [Luma; 2],
    /// Change of the right view's brightness.
    pub brightness: Brightness,
    /// The reference view, to which the map belongs.
    pub reference: View,
    /// First row of the map in the views.
    pub first_row: u32,
    /// The map.
    pub disparities: DisparityMap,
}

impl ResidualTrial {
    fn draw(Size { width, height }: Size, dice: &mut Dice) -> Self {
        let brightness = Brightness { gain: dice.pick(&[256, 100, 700]), offset: dice.pick(&[0, 9000, -9000]) };
        let views = [dice.picture((width, height)), dice.picture((width, height))];
        let first_row = dice.below(height);
        let disparities = map(Size::new(width, height - first_row), dice, -30 * SCALE, 60 * SCALE);
        Self { views, brightness, reference: dice.view(), first_row, disparities }
    }
}

impl Trial for ResidualTrial {
    fn parameters(&self) -> String {
        let Self { brightness: Brightness { gain, offset }, reference, first_row, .. } = self;
        format!("{reference:?}, gain {gain}, offset {offset}, from row {first_row} on")
    }

    fn input(&self) -> Vec<Array> {
        let [left, right] = &self.views;
        vec![
            Array::exact("left", left.data().to_vec()),
            Array::exact("right", right.data().to_vec()),
            Array::exact("disparities", self.disparities.data().to_vec()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.disparities.size());
        let [left, right] = [bench.upload_luma(&self.views[0])?, bench.upload_luma(&self.views[1])?];
        let views = ComparedViews {
            luma: [&left, &right],
            brightness: &uniform_buffer(gpu, "brightness", &self.brightness),
            reference: self.reference,
        };
        let disparities = bench.upload(self.disparities.data())?;
        let residuals = bench.output(size.width.div_ceil(4) * size.height)?;
        let dispatch = Residual::new(gpu).prepare(size, self.first_row, views, &disparities, &residuals);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("residuals", bench.download::<u32>(&residuals)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let Size { width, height: rows } = self.disparities.size();
        let rows_of = |view: &Luma| Plane::from_fn((width, rows), |x, y| view.get(x, self.first_row + y));
        let [left, right] = self.views.each_ref().map(rows_of);
        let right = right.map(|&luma| self.brightness.apply(luma));
        let found = residual([&left, &right], self.reference, &self.disparities);
        Ok(vec![Array::exact("residuals", pack(&found))])
    }
}

/// A map whose speckles are removed.
#[derive(Clone, Debug)]
pub struct SupportTrial {
    /// The map.
    pub dense: Dense,
    /// Photometric residuals of its pixels.
    pub residuals: Plane<u8>,
    /// Least number of pixels that must agree.
    pub least: u32,
    /// Whether half of the window must nearly agree.
    pub majority: bool,
    /// Where threads keep their windows.
    pub windows: Windows,
}

impl SupportTrial {
    fn draw(size: Size, dice: &mut Dice, windows: Windows) -> Self {
        let most = dice.pick(&[1, 8, u32::from(MAX_RESIDUAL) + 1]);
        let residuals = Plane::from_fn(size, |_, _| dice.below(most) as u8);
        let (least, majority) = (dice.pick(&[0, 1, 9, 25, 49]), dice.coin());
        Self { dense: dense(size, dice), residuals, least, majority, windows }
    }
}

impl Trial for SupportTrial {
    fn parameters(&self) -> String {
        format!("at least {}, majority {}", self.least, self.majority)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("matches", matches(&self.dense)), Array::exact("residuals", self.residuals.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.dense.disparity.size());
        let layout = MapLayout { width: size.width, rows: size.height };
        let words = matches(&self.dense);
        let (from, to) = (bench.upload(&words)?, bench.output(words.len() as u32)?);
        let residuals = bench.upload_luma(&self.residuals)?;
        let kernel = Support::new(gpu, self.least, self.majority, self.windows);
        let dispatch = kernel.prepare(MapBuffer { buffer: &from, layout }, &residuals, &to);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&to)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let dense = support(&self.dense, &self.residuals, self.least, self.majority);
        Ok(arrays(&matches(&dense), dense.disparity.data().len()))
    }
}

/// A map to be copied to a texture.
#[derive(Clone, Debug)]
pub struct MapTextureTrial {
    /// The map.
    pub disparities: DisparityMap,
    /// Kind of the texels.
    pub texel: MapTexel,
    /// Number of parts in which the map is copied.
    pub parts: u32,
}

impl MapTextureTrial {
    fn draw(Size { width, height }: Size, dice: &mut Dice) -> Self {
        // Larger textures are not required of a device.
        let size = Size::new(width.min(2048), height.min(2048));
        let texel = dice.pick(&MapTexel::ALL);
        Self { disparities: map(size, dice, -300 * SCALE, 2000 * SCALE), texel, parts: 1 + dice.below(3) }
    }
}

impl Trial for MapTextureTrial {
    fn parameters(&self) -> String {
        format!("{:?} in {} parts", self.texel, self.parts)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("disparities", self.disparities.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, Size { width, height }) = (bench.gpu, self.disparities.size());
        let from = bench.upload(self.disparities.data())?;
        let texture = bench.output_texture(self.texel.format(), (width, height));
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let kernel = MapTexture::new(gpu, self.texel);
        bench.run(|encoder| {
            let rows = height.div_ceil(self.parts);
            for first_row in (0..height).step_by(rows as usize) {
                let rows = rows.min(height - first_row);
                let rows = MapRows { width, rows, first_word: width * first_row, first_row };
                kernel.prepare(rows, &from, &view).record(encoder);
            }
        });
        Ok(vec![match self.texel {
            MapTexel::FixedPoint => Array::exact("texels", bench.download_texture::<i32>(&texture)?),
            MapTexel::Pixels => Array::exact("texels", bench.download_texture::<f32>(&texture)?),
        }])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![match self.texel {
            MapTexel::FixedPoint => Array::exact("texels", self.disparities.data().to_vec()),
            MapTexel::Pixels => Array::exact("texels", map_texture(&self.disparities)),
        }])
    }
}

/// A map to be filtered.
#[derive(Clone, Debug)]
pub struct MedianTrial {
    /// Luma of the view of the map.
    pub luma: Luma,
    /// The map.
    pub disparities: DisparityMap,
    /// The filter.
    pub median: Median,
    /// Where threads keep their windows.
    pub windows: Windows,
}

impl MedianTrial {
    fn draw(size: Size, dice: &mut Dice, windows: Windows) -> Self {
        let median = Median { radius: 1 + dice.below(4), halving_bits: dice.pick(&[0, 3, 5, 31]) };
        Self { luma: dice.picture(size), disparities: map(size, dice, -40 * SCALE, 60 * SCALE), median, windows }
    }
}

impl Trial for MedianTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.median)
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("luma", self.luma.data().to_vec()),
            Array::exact("disparities", self.disparities.data().to_vec()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (gpu, size) = (bench.gpu, self.disparities.size());
        let from = bench.upload(self.disparities.data())?;
        let (luma, to) = (bench.upload_luma(&self.luma)?, bench.output(size.width * size.height)?);
        let dispatch = WeightedMedian::new(gpu, self.median, self.windows).prepare(size, (&luma, 0), &from, &to);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("filtered disparities", bench.download::<i32>(&to)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let filtered = weighted_median(&self.luma, &self.disparities, self.median);
        Ok(vec![Array::exact("filtered disparities", filtered.into_data())])
    }
}

/// A map to be taken to another picture.
#[derive(Clone, Debug)]
pub struct MapBackTrial {
    /// The map, of the source size of `back`.
    pub dense: Dense,
    /// Where each pixel of the other picture lies in that of the map.
    pub back: WarpMap,
}

impl MapBackTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let source_size = source_size(size, dice);
        Self { dense: dense(source_size, dice), back: warp_map(size, source_size, dice) }
    }
}

impl Trial for MapBackTrial {
    fn parameters(&self) -> String {
        let back = &self.back;
        format!("{} from {}, a node per {}", back.size(), back.source_size(), 1 << back.spacing_bits())
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("matches", matches(&self.dense)),
            Array::exact("nodes", self.back.node_coordinates().into_flattened()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.back.size();
        let layout = MapLayout { width, rows: height };
        let disparities = bench.upload(self.dense.disparity.data())?;
        let confidences = bench.upload(&pack(&self.dense.confidence))?;
        let nodes = bench.upload(&self.back.node_coordinates())?;
        let map = bench.output(layout.words() as u32)?;
        let to = MapBuffer { buffer: &map, layout };
        let dispatch = MapBack::new(bench.gpu).prepare(&self.back, &nodes, [&disparities, &confidences], to);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(arrays(&bench.download(&map)?, layout.pixels() as usize))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let dense = map_back(&self.dense, &self.back);
        Ok(arrays(&matches(&dense), dense.disparity.data().len()))
    }
}
