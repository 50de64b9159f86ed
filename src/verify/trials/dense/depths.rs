//! Depths, confidences and points of a map.

use super::{blocks::signed, maps::dense};
use crate::{
    calibration::Calibration,
    cpu::dense::{PointList, confidence_texture, depth_texture, point_counts, points},
    dense::{
        Dense,
        kernels::{
            ARGUMENTS, ConfidenceTexture, DepthTexture, PointCounts, PointLayout, PointRule, PointSources, Points,
        },
        reprojection::DepthTable,
    },
    disparity::{DisparityRange, SCALE},
    error::Result,
    image::{Plane, Size},
    luma::{TexelFormat, pack},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("depth_texture", |size, dice| Box::new(DepthTextureTrial::draw(size, dice))),
    Subject::kernel("confidence_texture", |size, dice| Box::new(ConfidenceTextureTrial::draw(size, dice))),
    Subject::kernel("point_counts", |size, dice| Box::new(PointCountsTrial::draw(size, dice))),
    Subject::kernel("points", |size, dice| Box::new(PointsTrial::draw(size, dice))),
];

/// Larger textures are not required of a device.
fn within_textures(Size { width, height }: Size) -> Size {
    Size::new(width.min(2048), height.min(2048))
}

/// Draws the depths of a range that most disparities of drawn maps lie in.
fn table(dice: &mut Dice) -> DepthTable {
    let range = DisparityRange { min: dice.between(-40, 10), count: 1 + dice.below(90) };
    let doffs = f64::from(dice.between(-20, 20)) / 3.0;
    let (focal, baseline) = (f64::from(1 + dice.below(3000)) / 3.0, f64::from(1 + dice.below(100)) / 300.0);
    let calibration = Calibration { focal, baseline, doffs, cx: 0.0, cy: 0.0, size: None };
    DepthTable::new(range, &calibration)
}

fn rule(dice: &mut Dice) -> PointRule {
    let least = dice.between(-10 * SCALE, 40 * SCALE);
    PointRule { least: dice.pick(&[least, least, i32::MIN + 1, i32::MAX]), min_confidence: dice.below(256) as u8 }
}

fn input(dense: &Dense) -> Vec<Array> {
    vec![
        Array::exact("disparities", dense.disparity.data().to_vec()),
        Array::exact("confidences", dense.confidence.data().to_vec()),
    ]
}

/// A map whose depths are written to a texture.
#[derive(Clone, Debug)]
pub struct DepthTextureTrial {
    /// The map.
    pub dense: Dense,
    /// The depths of its disparities.
    pub table: DepthTable,
}

impl DepthTextureTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { dense: dense(within_textures(size), dice), table: table(dice) }
    }
}

impl Trial for DepthTextureTrial {
    fn parameters(&self) -> String {
        format!("disparities {} to {}", self.table.first(), self.table.last())
    }

    fn input(&self) -> Vec<Array> {
        let mut input = input(&self.dense);
        input.push(Array::exact("table", signed(&self.table.words())));
        input
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let map = &self.dense.disparity;
        let (disparities, words) = (bench.upload(map.data())?, bench.upload_words(&self.table.words())?);
        let texture = bench.output_texture(DepthTexture::FORMAT, map.size());
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let dispatch = DepthTexture::new(bench.gpu).prepare(map.size(), &disparities, &self.table, &words, &view);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("depths", bench.download_texture::<f32>(&texture)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("depths", depth_texture(&self.dense.disparity, &self.table))])
    }
}

/// A map whose confidences are written to a texture.
#[derive(Clone, Debug)]
pub struct ConfidenceTextureTrial(pub Plane<u8>);

impl ConfidenceTextureTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self(dice.picture(within_textures(size)))
    }
}

impl Trial for ConfidenceTextureTrial {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("confidences", self.0.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let confidences = bench.upload_luma(&self.0)?;
        let texture = bench.output_texture(ConfidenceTexture::FORMAT, self.0.size());
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let dispatch = ConfidenceTexture::new(bench.gpu).prepare(self.0.size(), &confidences, &view);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("texels", bench.download_texture::<u32>(&texture)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("texels", confidence_texture(&self.0))])
    }
}

/// A map whose points are counted.
#[derive(Clone, Debug)]
pub struct PointCountsTrial {
    /// The map.
    pub dense: Dense,
    /// Which pixels are points.
    pub rule: PointRule,
}

impl PointCountsTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { dense: dense(size, dice), rule: rule(dice) }
    }
}

impl Trial for PointCountsTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.rule)
    }

    fn input(&self) -> Vec<Array> {
        input(&self.dense)
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.dense.disparity.size();
        let disparities = bench.upload(self.dense.disparity.data())?;
        let confidences = bench.upload(&pack(&self.dense.confidence))?;
        let counts = bench.output(PointCounts::words(size.height))?;
        let map = [&disparities, &confidences];
        let dispatch = PointCounts::new(bench.gpu).prepare(size, self.rule, map, &counts);
        bench.run(|encoder| dispatch.record(encoder));
        let counts = bench.download::<u32>(&counts)?[ARGUMENTS as usize..].to_vec();
        Ok(vec![Array::exact("counts", counts)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("counts", point_counts(&self.dense, self.rule))])
    }
}

/// A map whose points are written.
#[derive(Clone, Debug)]
pub struct PointsTrial {
    /// The map.
    pub dense: Dense,
    /// Red, green, blue and alpha of the reference view.
    pub picture: Plane<[u8; 4]>,
    /// The depths of the map's disparities.
    pub table: DepthTable,
    /// Which pixels are points.
    pub rule: PointRule,
    /// How the points are written.
    pub layout: PointLayout,
}

impl PointsTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let dense = dense(within_textures(size), dice);
        let size = dense.disparity.size();
        let channels = [0; 4].map(|_| dice.picture(size));
        let pixels = size.pixels() as u32;
        let few = 1 + dice.below(pixels);
        let layout = PointLayout {
            centre: [0; 2].map(|_| dice.between(-100, 3000) as f32 / 7.0),
            capacity: dice.pick(&[pixels, pixels, few]),
            instanced: dice.pick(&[0, 1, 4]),
        };
        Self {
            picture: Plane::from_fn(size, |x, y| channels.each_ref().map(|channel| channel.get(x, y))),
            table: table(dice),
            rule: rule(dice),
            layout,
            dense,
        }
    }

    fn arrays(PointList { arguments, vertices }: PointList) -> Vec<Array> {
        let mut positions = Vec::new();
        let mut attributes = Vec::new();
        for [x, y, z, attribute] in vertices {
            positions.extend([x, y, z].map(f32::from_bits));
            attributes.push(attribute);
        }
        vec![
            Array::exact("arguments", arguments.to_vec()),
            Array::exact("positions", positions),
            Array::exact("colours and confidences", attributes),
        ]
    }
}

impl Trial for PointsTrial {
    fn parameters(&self) -> String {
        format!("{:?}, {:?}", self.rule, self.layout)
    }

    fn input(&self) -> Vec<Array> {
        let mut input = input(&self.dense);
        input.push(Array::exact("table", signed(&self.table.words())));
        input.push(Array::exact("picture", self.picture.data().as_flattened().to_vec()));
        input
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.dense.disparity.size();
        let disparities = bench.upload(self.dense.disparity.data())?;
        let confidences = bench.upload(&pack(&self.dense.confidence))?;
        let words = bench.upload_words(&self.table.words())?;
        let format = wgpu::TextureFormat::Rgba8Unorm;
        let picture = bench.texture(format, size, self.picture.data().as_flattened());
        let counts = bench.output(PointCounts::words(size.height))?;
        let vertices = bench.output(4 * self.layout.capacity)?;
        let texel = TexelFormat::new(format).expect("an accepted format");
        let sources =
            PointSources { size, disparities: &disparities, confidences: &confidences, picture: (&picture, texel) };
        let counting = PointCounts::new(bench.gpu).prepare(size, self.rule, [&disparities, &confidences], &counts);
        let to = [&counts, &vertices];
        let writing = Points::new(bench.gpu).prepare(sources, self.rule, (&self.table, &words), self.layout, to);
        bench.run(|encoder| {
            counting.record(encoder);
            writing.record(encoder);
        });
        let arguments: [u32; 4] = bench.download::<u32>(&counts)?[..4].try_into().expect("four words");
        let count = arguments[usize::from(self.layout.instanced != 0)] as usize;
        let mut vertices = bench.download::<[u32; 4]>(&vertices)?;
        vertices.truncate(count);
        Ok(Self::arrays(PointList { arguments, vertices }))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let picture = self.picture.map(|&[red, green, blue, _]| [red, green, blue]);
        Ok(Self::arrays(points(&self.dense, &picture, &self.table, self.rule, self.layout)))
    }
}
