//! Resampling of a view.

use glam::DVec2;

use crate::{
    cpu::rectify::{warp, warp_colours},
    error::Result,
    image::{Luma, Size},
    io::Picture,
    luma::{pack, packed_bytes},
    rectify::{
        WarpMap,
        kernels::{warp::Warp, warp_colours::WarpColours},
    },
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("warp", |size, dice| Box::new(WarpTrial::draw(size, dice))),
    Subject::kernel("warp_colours", |size, dice| Box::new(WarpColoursTrial::draw(size, dice))),
];

/// A picture to be resampled.
#[derive(Clone, Debug)]
pub struct WarpTrial {
    /// The picture, of the map's source size.
    pub source: Luma,
    /// The map.
    pub map: WarpMap,
}

impl WarpTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let source_size = source_size(size, dice);
        let source = dice.picture(source_size);
        Self { source, map: map(size, source_size, dice) }
    }
}

/// Draws the size of a source.
pub(in crate::verify::trials) fn source_size(size: Size, dice: &mut Dice) -> Size {
    let mut other = |side: u32| 1 + side / 2 + dice.below(side);
    Size::new(other(size.width), other(size.height))
}

/// Draws the map of a picture of `size`.
pub(in crate::verify::trials) fn map(size: Size, source_size: Size, dice: &mut Dice) -> WarpMap {
    let mut part = |most: f64| most * f64::from(dice.between(-1000, 1000)) / 1000.0;
    // The whole source, enlarged to the picture, then moved, sheared and tilted.
    let scale = DVec2::new(ratio(source_size.width, size.width), ratio(source_size.height, size.height));
    let (shift, shear) = (DVec2::new(part(8.0), part(8.0)), DVec2::new(part(0.3), part(0.3)));
    let tilt = DVec2::new(part(0.5) / f64::from(size.width), part(0.5) / f64::from(size.height));
    let tilted = |p: DVec2| (scale * p + shear * DVec2::new(p.y, p.x) + shift) / (1.0 + tilt.dot(p));
    let is_whole = dice.below(8) == 0;
    // Sometimes a node has no position.
    let hole =
        DVec2::new((16 * dice.below(size.width / 16 + 2)).into(), (16 * dice.below(size.height / 16 + 2)).into());
    let has_hole = dice.below(3) == 0;
    let spacing_bits = 1 + dice.below(4);
    let map = WarpMap::with_spacing(spacing_bits, size, source_size, &|p| match p {
        p if has_hole && p == hole => DVec2::NAN,
        p if is_whole => p + shift.floor(),
        p => tilted(p),
    });
    map.expect("sides of cases are far below the limit")
}

fn ratio(a: u32, b: u32) -> f64 {
    f64::from(a) / f64::from(b)
}

impl Trial for WarpTrial {
    fn parameters(&self) -> String {
        format!("{} from {}, a node per {}", self.map.size(), self.map.source_size(), 1 << self.map.spacing_bits())
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("source", self.source.data().to_vec()),
            Array::exact("nodes", self.map.node_coordinates().into_flattened()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let warped = bench.output((packed_bytes(self.map.size()) / 4) as u32)?;
        let nodes = bench.upload(&self.map.node_coordinates())?;
        let source = bench.upload_luma(&self.source)?;
        let dispatch = Warp::new(bench.gpu).prepare(&self.map, &source, &nodes, &warped);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("warped", bench.download::<u32>(&warped)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("warped", pack(&warp(&self.source, &self.map)))])
    }
}

/// A picture in colour to be resampled.
#[derive(Clone, Debug)]
pub struct WarpColoursTrial {
    /// The picture, of the map's source size.
    pub source: Picture,
    /// The map.
    pub map: WarpMap,
    /// First row of the second band of the warped picture.
    pub cut: u32,
}

impl WarpColoursTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let source_size = source_size(size, dice);
        let channels = [(); 4].map(|()| dice.picture(source_size));
        let source = Picture::from_fn(source_size, |x, y| channels.each_ref().map(|channel| channel.get(x, y)));
        Self { source, map: map(size, source_size, dice), cut: dice.below(size.height) }
    }
}

impl Trial for WarpColoursTrial {
    fn parameters(&self) -> String {
        let Self { map, cut, .. } = self;
        format!("{} from {}, a node per {}, cut at {cut}", map.size(), map.source_size(), 1 << map.spacing_bits())
    }

    fn input(&self) -> Vec<Array> {
        vec![
            Array::exact("source", self.source.rgba().to_vec()),
            Array::exact("nodes", self.map.node_coordinates().into_flattened()),
        ]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let Size { width, height } = self.map.size();
        let (source, nodes) = (bench.upload(self.source.data())?, bench.upload(&self.map.node_coordinates())?);
        let kernel = WarpColours::new(bench.gpu);
        let mut warped = Vec::new();
        for (first_row, end) in [(0, self.cut), (self.cut, height)] {
            if first_row < end {
                let band = bench.output(width * (end - first_row))?;
                let dispatch = kernel.prepare(&self.map, [first_row, end - first_row], &source, &nodes, &band);
                bench.run(|encoder| dispatch.record(encoder));
                warped.extend(bench.download::<u32>(&band)?);
            }
        }
        Ok(vec![Array::exact("warped", warped)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let warped = warp_colours(&self.source, &self.map);
        Ok(vec![Array::exact(
            "warped",
            warped.data().iter().map(|&pixel| u32::from_le_bytes(pixel)).collect::<Vec<_>>(),
        )])
    }
}
