//! Interest points: the determinant of the Hessian, its maxima, and the workgroups of the later stages.

use super::tolerances::PLACES;
use crate::{
    cpu::features::{
        hessian::{Octave, Response},
        integral::IntegralImage,
        nonmax::{candidates, integer_threshold, locate},
        workgroups::workgroups,
    },
    error::Result,
    features::{
        FeatureConfig,
        kernels::{
            hessian::{Grid, Hessian},
            nonmax::Nonmax,
            workgroups::Workgroups,
        },
        keypoints::{DISPATCH_WIDTH, Keypoint, KeypointList},
    },
    image::{Luma, Plane, Size},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("hessian", |size, dice| Box::new(HessianTrial::draw(size, dice))),
    Subject::kernel("nonmax", |size, dice| Box::new(NonmaxTrial::draw(size, dice))),
    Subject::kernel("workgroups", |size, dice| Box::new(WorkgroupsTrial::draw(size, dice))),
];

/// The names of an octave's arrays, the finest first.
const OCTAVES: [&str; 5] = ["octave 0", "octave 1", "octave 2", "octave 3", "octave 4"];

/// A picture whose determinants are computed.
#[derive(Clone, Debug)]
pub struct HessianTrial {
    /// The picture.
    pub picture: Luma,
    /// Number of octaves, 1 to 5.
    pub octaves: u32,
    /// Sampling step of the first octave, 1 or 2 pixels.
    pub step: u32,
}

impl HessianTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { octaves: dice.pick(&[1, 3, 5, 5, 5]), step: dice.pick(&[1, 2]), picture: dice.picture(size) }
    }
}

impl Trial for HessianTrial {
    fn parameters(&self) -> String {
        format!("{} octaves, step {}", self.octaves, self.step)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.picture.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let size = self.picture.size();
        let integral = bench.upload(IntegralImage::new(&self.picture).sums().data())?;
        let config = FeatureConfig { octaves: self.octaves, step: self.step, ..FeatureConfig::default() };
        let kernel = Hessian::new(bench.gpu, &config);
        let output = |octave| bench.output((kernel.bytes(size, octave) / 4) as u32);
        let responses = (0..self.octaves).map(output).collect::<Result<Vec<_>>>()?;
        let finer = |octave: u32| octave.checked_sub(1).map(|finer| &responses[finer as usize]);
        bench.run(|encoder| {
            for (octave, responses) in (0..).zip(&responses) {
                kernel.prepare(size, octave, &integral, finer(octave), responses).record(encoder);
            }
        });
        let octave = |(responses, name)| Ok(Array::exact(name, bench.download::<i32>(responses)?));
        responses.iter().zip(OCTAVES).map(octave).collect()
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let integral = IntegralImage::new(&self.picture);
        let octave = |(octave, name)| {
            let octave = Octave::new(&integral, octave, self.step);
            let words: Vec<i32> = octave.layers.iter().flat_map(|layer| layer.data()).map(|word| word.0).collect();
            Array::exact(name, words)
        };
        Ok((0..self.octaves).zip(OCTAVES).map(octave).collect())
    }
}

/// Responses whose maxima are found.
#[derive(Clone, Debug)]
pub struct NonmaxTrial {
    /// Size of the picture.
    pub size: Size,
    /// Parameters of detection.
    pub config: FeatureConfig,
    /// Responses of each octave, from [`Hessian::prepare`].
    pub responses: Vec<Vec<i32>>,
}

impl NonmaxTrial {
    /// The responses of a picture.
    pub fn of_picture(picture: &Luma, config: FeatureConfig) -> Self {
        let integral = IntegralImage::new(picture);
        let octave = |octave| {
            let layers = Octave::new(&integral, octave, config.step).layers;
            layers.iter().flat_map(|layer| layer.data()).map(|word| word.0).collect()
        };
        Self { size: picture.size(), responses: (0..config.octaves).map(octave).collect(), config }
    }

    /// The number of keypoints that the device finds, and the keypoints in the list, sorted.
    ///
    /// # Errors
    /// The errors of the device.
    pub fn keypoints(&self, bench: &Bench<'_>) -> Result<(u32, Vec<Keypoint>)> {
        let list = KeypointList::new(bench.gpu, self.config.max_features)?;
        bench.poison(list.keypoints());
        bench.write(list.count(), &[0_u32]);
        let kernel = Nonmax::new(bench.gpu);
        for (octave, responses) in (0..).zip(&self.responses) {
            let dispatch = kernel.prepare(self.size, octave, &self.config, &bench.upload(responses)?, &list);
            bench.run(|encoder| dispatch.record(encoder));
        }
        let found = bench.download::<u32>(list.count())?[0];
        let mut keypoints: Vec<Keypoint> = bench.download(list.keypoints())?;
        keypoints.truncate(found.min(self.config.max_features) as usize);
        keypoints.sort_by_key(Keypoint::key);
        Ok((found, keypoints))
    }

    /// The keypoints that the twin finds, sorted.
    pub fn twins_keypoints(&self) -> Vec<Keypoint> {
        let Size { width, height } = self.size;
        let octave = |(index, responses): (u32, &Vec<i32>)| {
            let grid = Grid::new((width, height), self.config.step, index);
            let points = (grid.width * grid.height) as usize;
            let layers = [0, 1, 2, 3].map(|layer: usize| {
                let words = &responses[layer * points..][..points];
                Plane::from_fn((grid.width, grid.height), |x, y| Response(words[(y * grid.width + x) as usize]))
            });
            let octave = Octave { index, spacing: grid.step, layers };
            let found = candidates(&octave, width, height, integer_threshold(self.config.threshold));
            let keypoint = |at| {
                let place = locate(&octave, at);
                Keypoint {
                    x: place.x,
                    y: place.y,
                    scale: place.scale,
                    orientation: 0.0,
                    response: octave.layers[at.layer as usize].get(at.i, at.j).0,
                    octave: index,
                    index: ((at.layer - 1) * grid.height + at.j) * grid.width + at.i,
                }
            };
            found.into_iter().map(keypoint).collect::<Vec<_>>()
        };
        (0..).zip(&self.responses).flat_map(octave).collect()
    }

    /// Outputs of the trial, with `found` keypoints found. If more are found than fit in the list, which of them are
    /// kept is not determined.
    fn arrays(&self, found: u32, keypoints: &[Keypoint]) -> Vec<Array> {
        let listed = if found > self.config.max_features { &[] } else { keypoints };
        let samples = |k: &Keypoint| [k.octave, k.index, k.response.cast_unsigned(), k.orientation.to_bits()];
        let places = |k: &Keypoint| [k.x, k.y, k.scale];
        vec![
            Array::exact("number found", vec![found]),
            Array::exact("octave, index, response, orientation", listed.iter().flat_map(samples).collect::<Vec<_>>()),
            Array {
                name: "x, y, scale",
                values: listed.iter().flat_map(places).collect::<Vec<_>>().into(),
                tolerance: PLACES,
            },
        ]
    }
}

impl NonmaxTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let config = FeatureConfig {
            octaves: dice.pick(&[1, 4, 5]),
            step: dice.pick(&[1, 2]),
            threshold: dice.pick(&[0.000_001, 0.000_1, 0.01]),
            max_features: dice.pick(&[5, 65_536, 65_536, 65_536]),
            ..FeatureConfig::default()
        };
        Self::of_picture(&dice.picture(size), config)
    }
}

impl Trial for NonmaxTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.config)
    }

    fn input(&self) -> Vec<Array> {
        let octaves = self.responses.iter().zip(OCTAVES);
        octaves.map(|(responses, name)| Array::exact(name, responses.clone())).collect()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (found, keypoints) = self.keypoints(bench)?;
        Ok(self.arrays(found, &keypoints))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let keypoints = self.twins_keypoints();
        Ok(self.arrays(keypoints.len() as u32, &keypoints))
    }
}

/// The size of a keypoint list, from which the workgroups of the later stages follow.
#[derive(Clone, Debug)]
pub struct WorkgroupsTrial {
    /// Number of keypoints found.
    pub found: u32,
    /// Capacity of the list, in keypoints.
    pub capacity: u32,
}

impl WorkgroupsTrial {
    fn draw(Size { width, height }: Size, dice: &mut Dice) -> Self {
        let capacity = 1 + dice.below((width * height).min(1 << 16));
        Self { found: dice.pick(&[0, capacity, capacity + 1, capacity / 2, u32::MAX]), capacity }
    }
}

impl Trial for WorkgroupsTrial {
    fn parameters(&self) -> String {
        format!("{} found, room for {}", self.found, self.capacity)
    }

    fn input(&self) -> Vec<Array> {
        Vec::new()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let list = KeypointList::new(bench.gpu, self.capacity)?;
        bench.write(list.count(), &[self.found]);
        let groups = Workgroups::groups(bench.gpu);
        bench.poison(&groups);
        let dispatch = Workgroups::new(bench.gpu).prepare(&list, &groups);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(vec![Array::exact("workgroups", bench.download::<u32>(&groups)?)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("workgroups", workgroups(self.found, self.capacity, DISPATCH_WIDTH).to_vec())])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::trials::features::differ;

    #[test]
    fn a_changed_keypoint_is_seen() {
        let good = Keypoint { x: 30.0, y: 20.0, scale: 2.0, orientation: 0.0, response: 9, octave: 1, index: 5 };
        let trial = NonmaxTrial { size: Size::new(64, 64), config: FeatureConfig::default(), responses: Vec::new() };
        let arrays = |keypoint| trial.arrays(1, &[keypoint]);
        assert!(!differ(&arrays(good), &arrays(good)));
        assert!(!differ(&arrays(Keypoint { x: 30.000_1, ..good }), &arrays(good)));
        for changed in [
            Keypoint { x: 30.001, ..good },
            Keypoint { y: 19.999, ..good },
            Keypoint { scale: 2.001, ..good },
            Keypoint { orientation: 1e-9, ..good },
            Keypoint { response: 8, ..good },
            Keypoint { octave: 0, ..good },
            Keypoint { index: 6, ..good },
            Keypoint { x: f32::NAN, ..good },
        ] {
            assert!(differ(&arrays(changed), &arrays(good)), "{changed:?}");
        }
        assert!(differ(&trial.arrays(2, &[good]), &arrays(good)));
    }
}
