//! Interest points: the determinant of the Hessian, its maxima, orientations, descriptors, and all of it together.
//!
//! What is no integer has a tolerance, which stands here and nowhere else.

use std::f32::consts::{PI, TAU};

use super::{
    array::{Array, Outliers, Tolerance},
    bench::Bench,
    case::{Subject, Trial},
    dice::{Dice, Size},
};
use crate::{
    cpu::features::{
        descriptor::descriptor,
        detector,
        haar::Place,
        hessian::{Octave, Response},
        integral::IntegralImage,
        nonmax::{candidates, integer_threshold, locate},
        orientation::{is_decided, orientation},
        workgroups::workgroups,
    },
    error::Result,
    features::{
        Feature, FeatureConfig, detect,
        kernels::{
            descriptor::Descriptor,
            hessian::{Grid, Hessian},
            nonmax::Nonmax,
            orientation::Orientation,
            workgroups::Workgroups,
        },
        keypoints::{DISPATCH_WIDTH, Keypoint, KeypointList},
    },
    gpu::block_on,
    image::{Luma, Plane},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("hessian", |size, dice| Box::new(HessianTrial::draw(size, dice))),
    Subject::kernel("nonmax", |size, dice| Box::new(NonmaxTrial::draw(size, dice))),
    Subject::kernel("workgroups", |size, dice| Box::new(WorkgroupsTrial::draw(size, dice))),
    Subject::kernel("orientation", |size, dice| Box::new(OrientationTrial::draw(size, dice))),
    Subject::kernel("descriptor", |size, dice| Box::new(DescriptorTrial::draw(size, dice))),
    Subject::pipeline("features", |size, dice| Box::new(FeaturesTrial::draw(size, dice))),
];

/// Of places and scales, in pixels, three numbers a keypoint.
///
/// The division that places a maximum between its samples may be off by 2.5 units in the last place of half a sample,
/// and samples are up to 32 px apart; the place is rounded to 1/8192 px from 1024 px on.
const PLACES: Tolerance =
    Tolerance::Within { difference: 1.0 / 4096.0, angles: false, group: 3, length: None, outliers: None };

/// Of orientations that no last digit decides.
///
/// The twin adds floats, the kernel whole numbers of 1/32768 grey level, and the `atan2` of a device may be off by 4096
/// units in the last place; on lavapipe they are at most 0.0004 apart.
const ORIENTATIONS: Tolerance =
    Tolerance::Within { difference: 1e-3, angles: true, group: 1, length: None, outliers: None };

/// The same of any: where a gradient is at the very end of a window, or two windows' sums are equally long, the last
/// digit decides which window wins, and with it between any two directions. On lavapipe it is one of 15,088.
const ORIENTATIONS_ANYWHERE: Tolerance = Tolerance::Within {
    difference: 1e-3,
    angles: true,
    group: 1,
    length: None,
    outliers: Some(Outliers { of_thousand: 5, difference: PI }),
};

/// Of descriptors: some may be off, and are descriptors all the same, as long as they should be.
const fn of_descriptors(difference: f32, outliers: Option<Outliers>) -> Tolerance {
    Tolerance::Within { difference, angles: false, group: 64, length: Some(1e-4), outliers }
}

/// What samples of which some are rounded to another 1/16 px change of a descriptor's values: on lavapipe up to 0.011.
const ANOTHER_SIXTEENTH: f32 = 0.016;

/// Of the 64 values of a descriptor.
///
/// Upright, all samples are the same integers in both, and only their cube roots and sums are floats (on lavapipe
/// 6e-7 apart). Turned, the place of each sample is a float that is rounded to 1/16 px, sometimes the other way:
/// allowed at one descriptor in 200, on lavapipe at fewer than one in 10,000.
const fn descriptors(upright: bool) -> Tolerance {
    if upright {
        return of_descriptors(1e-5, None);
    }
    of_descriptors(1e-3, Some(Outliers { of_thousand: 5, difference: ANOTHER_SIXTEENTH }))
}

/// Of the same at places that are themselves only near, turned by orientations that are only near, some of which are
/// others altogether. On lavapipe none of 11,648 is off upright; turned, one of 15,088 by 0.18, that with another
/// orientation, and of some pictures more than one in 200 by up to 0.011: no case that is verified by default.
const fn descriptors_anywhere(upright: bool) -> Tolerance {
    if upright {
        return of_descriptors(1e-3, None);
    }
    of_descriptors(1e-3, Some(Outliers { of_thousand: 5, difference: 0.5 }))
}

/// The names of an octave's arrays, the finest first.
const OCTAVES: [&str; 5] = ["octave 0", "octave 1", "octave 2", "octave 3", "octave 4"];

/// A picture whose determinants are computed.
#[derive(Clone, Debug)]
pub struct HessianTrial {
    /// The picture.
    pub picture: Luma,
    /// How many octaves there are, 1 to 5.
    pub octaves: u32,
    /// The step of the first one, 1 or 2.
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

/// Responses whose maxima are sought.
#[derive(Clone, Debug)]
pub struct NonmaxTrial {
    /// Of the picture.
    pub size: Size,
    /// What is looked for.
    pub config: FeatureConfig,
    /// The responses of each octave, as [`Hessian::prepare`] leaves them.
    pub responses: Vec<Vec<i32>>,
}

impl NonmaxTrial {
    /// What `config` looks for in a picture.
    pub fn of_picture(picture: &Luma, config: FeatureConfig) -> Self {
        let integral = IntegralImage::new(picture);
        let octave = |octave| {
            let layers = Octave::new(&integral, octave, config.step).layers;
            layers.iter().flat_map(|layer| layer.data()).map(|word| word.0).collect()
        };
        Self { size: picture.size(), responses: (0..config.octaves).map(octave).collect(), config }
    }

    /// How many keypoints the device finds, and those there is room for, in order.
    ///
    /// # Errors
    /// What the device says.
    pub fn keypoints(&self, bench: &Bench<'_>) -> Result<(u32, Vec<Keypoint>)> {
        let list = KeypointList::new(bench.gpu, self.config.max_features)?;
        bench.poison(list.keypoints());
        bench.write(list.found(), &[0_u32]);
        let kernel = Nonmax::new(bench.gpu);
        for (octave, responses) in (0..).zip(&self.responses) {
            let dispatch = kernel.prepare(self.size, octave, &self.config, &bench.upload(responses)?, &list);
            bench.run(|encoder| dispatch.record(encoder));
        }
        let found = bench.download::<u32>(list.found())?[0];
        let mut keypoints: Vec<Keypoint> = bench.download(list.keypoints())?;
        keypoints.truncate(found.min(self.config.max_features) as usize);
        keypoints.sort_by_key(Keypoint::key);
        Ok((found, keypoints))
    }

    /// The same by the twin.
    pub fn twins_keypoints(&self) -> Vec<Keypoint> {
        let (width, height) = self.size;
        let octave = |(index, responses): (u32, &Vec<i32>)| {
            let grid = Grid::new(width, height, self.config.step, index);
            let points = (grid.width * grid.height) as usize;
            let layers = [0, 1, 2, 3].map(|layer: usize| {
                let words = &responses[layer * points..][..points];
                Plane::from_fn(grid.width, grid.height, |x, y| Response(words[(y * grid.width + x) as usize]))
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

    /// What is left, where `found` were found. Which ones are kept of more than there is room for is not determined.
    fn arrays(&self, found: u32, keypoints: &[Keypoint]) -> Vec<Array> {
        let kept = if found > self.config.max_features { &[] } else { keypoints };
        let samples = |k: &Keypoint| [k.octave, k.index, k.response.cast_unsigned(), k.orientation.to_bits()];
        let places = |k: &Keypoint| [k.x, k.y, k.scale];
        vec![
            Array::exact("number found", vec![found]),
            Array::exact("octave, index, response, orientation", kept.iter().flat_map(samples).collect::<Vec<_>>()),
            Array {
                name: "x, y, scale",
                values: kept.iter().flat_map(places).collect::<Vec<_>>().into(),
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

/// How many keypoints were found, from which the workgroups of what follows come.
#[derive(Clone, Debug)]
pub struct WorkgroupsTrial {
    /// How many were found.
    pub found: u32,
    /// How many there is room for.
    pub capacity: u32,
}

impl WorkgroupsTrial {
    fn draw((width, height): Size, dice: &mut Dice) -> Self {
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
        bench.write(list.found(), &[self.found]);
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

/// A list that holds `keypoints`, on the device, and the number of its workgroups.
fn list(bench: &Bench<'_>, keypoints: &[Keypoint]) -> Result<(KeypointList, wgpu::Buffer)> {
    let count = keypoints.len() as u32;
    let list = KeypointList::new(bench.gpu, count)?;
    bench.write(list.found(), &[count]);
    bench.write(list.keypoints(), keypoints);
    let groups = Workgroups::groups(bench.gpu);
    let dispatch = Workgroups::new(bench.gpu).prepare(&list, &groups);
    bench.run(|encoder| dispatch.record(encoder));
    Ok((list, groups))
}

/// Places anywhere in a picture and around it, of any scale and orientation.
fn places_in((width, height): Size, dice: &mut Dice) -> Vec<Keypoint> {
    let count = 1 + dice.below(400);
    let mut sixty_fourths = |least: f32, length: f32| least + dice.below((64.0 * length) as u32) as f32 / 64.0;
    let place = |_| Keypoint {
        x: sixty_fourths(-4.0, width as f32 + 8.0),
        y: sixty_fourths(-4.0, height as f32 + 8.0),
        scale: sixty_fourths(1.25, 40.0),
        orientation: sixty_fourths(0.0, TAU),
        response: 0,
        octave: 0,
        index: 0,
    };
    (0..count).map(place).collect()
}

/// A column so far outside any picture that no neighbourhood reaches in.
const NOTHING_THERE: f32 = -4096.0;

fn keypoint_input(picture: &Luma, keypoints: &[Keypoint]) -> Vec<Array> {
    let places = |k: &Keypoint| [k.x, k.y, k.scale, k.orientation];
    let places: Vec<f32> = keypoints.iter().flat_map(places).collect();
    vec![Array::exact("picture", picture.data().to_vec()), Array::exact("x, y, scale, orientation", places)]
}

fn place(keypoint: &Keypoint) -> Place {
    Place::new(keypoint.x, keypoint.y, keypoint.scale)
}

/// Keypoints of a picture whose orientations are sought.
#[derive(Clone, Debug)]
pub struct OrientationTrial {
    /// The picture.
    pub picture: Luma,
    /// The keypoints.
    pub keypoints: Vec<Keypoint>,
}

impl OrientationTrial {
    /// What the device makes of the keypoints.
    ///
    /// # Errors
    /// What the device says.
    pub fn oriented(&self, bench: &Bench<'_>) -> Result<Vec<Keypoint>> {
        // What is not written would be out of range.
        let poisoned = |keypoint: &Keypoint| Keypoint { orientation: f32::NAN, ..*keypoint };
        let (list, groups) = list(bench, &self.keypoints.iter().map(poisoned).collect::<Vec<_>>())?;
        let integral = bench.upload(IntegralImage::new(&self.picture).sums().data())?;
        let dispatch = Orientation::new(bench.gpu).prepare(self.picture.size(), &integral, &list, &groups);
        bench.run(|encoder| dispatch.record(encoder));
        bench.download(list.keypoints())
    }

    fn arrays(keypoints: &[Keypoint]) -> Vec<Array> {
        let orientations: Vec<f32> = keypoints.iter().map(|keypoint| keypoint.orientation).collect();
        // Nothing else of a keypoint changes.
        let rest = |keypoint: &Keypoint| {
            let Keypoint { x, y, scale, orientation: _, response, octave, index } = *keypoint;
            [x.to_bits(), y.to_bits(), scale.to_bits(), response.cast_unsigned(), octave, index]
        };
        vec![
            Array::exact("the rest of the keypoints", keypoints.iter().flat_map(rest).collect::<Vec<_>>()),
            Array { name: "orientations", values: orientations.into(), tolerance: ORIENTATIONS },
        ]
    }
}

impl OrientationTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let (picture, mut keypoints) = (dice.picture(size), places_in(size, dice));
        let integral = IntegralImage::new(&picture);
        for keypoint in keypoints.iter_mut().filter(|keypoint| !is_decided(&integral, place(keypoint))) {
            keypoint.x = NOTHING_THERE;
        }
        Self { picture, keypoints }
    }
}

impl Trial for OrientationTrial {
    fn parameters(&self) -> String {
        format!("{} keypoints", self.keypoints.len())
    }

    fn input(&self) -> Vec<Array> {
        keypoint_input(&self.picture, &self.keypoints)
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        Ok(Self::arrays(&self.oriented(bench)?))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let integral = IntegralImage::new(&self.picture);
        let oriented =
            |keypoint: &Keypoint| Keypoint { orientation: orientation(&integral, place(keypoint)), ..*keypoint };
        Ok(Self::arrays(&self.keypoints.iter().map(oriented).collect::<Vec<_>>()))
    }
}

/// Keypoints of a picture that are described.
#[derive(Clone, Debug)]
pub struct DescriptorTrial {
    /// The picture.
    pub picture: Luma,
    /// The keypoints.
    pub keypoints: Vec<Keypoint>,
    /// Whether along the axes of the picture, or of each keypoint.
    pub upright: bool,
}

impl DescriptorTrial {
    fn arrays(&self, values: Vec<f32>) -> Vec<Array> {
        vec![Array { name: "descriptors", values: values.into(), tolerance: descriptors(self.upright) }]
    }
}

impl DescriptorTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        Self { upright: dice.coin(), picture: dice.picture(size), keypoints: places_in(size, dice) }
    }
}

impl Trial for DescriptorTrial {
    fn parameters(&self) -> String {
        format!("{} keypoints, upright {}", self.keypoints.len(), self.upright)
    }

    fn input(&self) -> Vec<Array> {
        keypoint_input(&self.picture, &self.keypoints)
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let (list, groups) = list(bench, &self.keypoints)?;
        let integral = bench.upload(IntegralImage::new(&self.picture).sums().data())?;
        let descriptors = bench.output((Descriptor::bytes(&list) / 4) as u32)?;
        let kernel = Descriptor::new(bench.gpu, self.upright);
        let dispatch = kernel.prepare(self.picture.size(), &integral, &list, &groups, &descriptors);
        bench.run(|encoder| dispatch.record(encoder));
        Ok(self.arrays(bench.download(&descriptors)?))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        let integral = IntegralImage::new(&self.picture);
        let described = |keypoint: &Keypoint| {
            descriptor(&integral, place(keypoint), (!self.upright).then_some(keypoint.orientation))
        };
        Ok(self.arrays(self.keypoints.iter().flat_map(described).collect()))
    }
}

/// A picture whose interest points are found and described.
#[derive(Clone, Debug)]
pub struct FeaturesTrial {
    /// The picture.
    pub picture: Luma,
    /// What is looked for.
    pub config: FeatureConfig,
}

impl FeaturesTrial {
    /// Samples are exactly the same, places within a division's last digits, orientations and descriptors within theirs.
    fn arrays(features: &[Feature], upright: bool) -> Vec<Array> {
        let samples = |f: &Feature| [f.response.to_bits(), f.dark.into()];
        let places = |f: &Feature| [f.x, f.y, f.scale];
        let floats = |name, values: Vec<f32>, tolerance| Array { name, values: values.into(), tolerance };
        vec![
            Array::exact("response, dark", features.iter().flat_map(samples).collect::<Vec<_>>()),
            floats("x, y, scale", features.iter().flat_map(places).collect(), PLACES),
            floats("orientations", features.iter().map(|f| f.orientation).collect(), ORIENTATIONS_ANYWHERE),
            floats("descriptors", features.iter().flat_map(|f| f.descriptor).collect(), descriptors_anywhere(upright)),
        ]
    }
}

impl FeaturesTrial {
    fn draw(size: Size, dice: &mut Dice) -> Self {
        let config = FeatureConfig {
            octaves: dice.pick(&[2, 5, 5]),
            step: dice.pick(&[1, 1, 2]),
            threshold: dice.pick(&[0.000_03, 0.000_4]),
            upright: dice.coin(),
            ..FeatureConfig::default()
        };
        Self { config, picture: dice.picture(size) }
    }
}

impl Trial for FeaturesTrial {
    fn parameters(&self) -> String {
        format!("{:?}", self.config)
    }

    fn input(&self) -> Vec<Array> {
        vec![Array::exact("picture", self.picture.data().to_vec())]
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        Ok(Self::arrays(&block_on(detect(bench.gpu, &self.picture, &self.config))?, self.config.upright))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(Self::arrays(&detector::detect(&self.picture, &self.config)?, self.config.upright))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::array::Comparison, *};

    /// Whether device and twin would be told apart.
    fn differ(actual: &[Array], expected: &[Array]) -> bool {
        let differs = |(actual, expected)| Comparison::new(actual, expected).fault.is_some();
        actual.iter().zip(expected).any(differs)
    }

    /// What last digits decide is left out of the trial, and is not most of it.
    #[test]
    fn most_orientations_are_decided() {
        let trial = OrientationTrial::draw((311, 239), &mut Dice::new("orientation", 8));
        let left = trial.keypoints.iter().filter(|keypoint| keypoint.x != NOTHING_THERE).count();
        assert!(2 * left > trial.keypoints.len(), "{left} of {}", trial.keypoints.len());
    }

    #[test]
    fn a_changed_keypoint_is_seen() {
        let good = Keypoint { x: 30.0, y: 20.0, scale: 2.0, orientation: 0.0, response: 9, octave: 1, index: 5 };
        let trial = NonmaxTrial { size: (64, 64), config: FeatureConfig::default(), responses: Vec::new() };
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

    #[test]
    fn where_an_orientation_belongs_nothing_else_changes() {
        let good = Keypoint { x: 30.0, y: 20.0, scale: 2.0, orientation: 1.0, response: 9, octave: 1, index: 5 };
        let arrays = |keypoint: Keypoint| OrientationTrial::arrays(&[keypoint; 300]);
        assert!(!differ(&arrays(Keypoint { orientation: 1.000_9, ..good }), &arrays(good)));
        for changed in
            [Keypoint { orientation: 1.002, ..good }, Keypoint { x: 30.000_01, ..good }, Keypoint { index: 6, ..good }]
        {
            assert!(differ(&arrays(changed), &arrays(good)), "{changed:?}");
        }
    }

    #[test]
    fn a_changed_feature_is_seen() {
        let good = Feature {
            x: 30.0,
            y: 20.0,
            scale: 2.0,
            response: 0.01,
            dark: true,
            orientation: 1.0,
            descriptor: [0.125; 64],
        };
        let arrays = |feature: &Feature| FeaturesTrial::arrays(&vec![feature.clone(); 100], false);
        assert!(!differ(&arrays(&good), &arrays(&good)));
        let mut descriptor = good.descriptor;
        descriptor[0] = 0.13;
        for changed in [
            Feature { x: 30.001, ..good.clone() },
            Feature { y: 20.001, ..good.clone() },
            Feature { scale: 1.999, ..good.clone() },
            Feature { response: 0.010_001, ..good.clone() },
            Feature { dark: false, ..good.clone() },
            Feature { orientation: 1.002, ..good.clone() },
            Feature { descriptor, ..good.clone() },
        ] {
            assert!(differ(&arrays(&changed), &arrays(&good)), "{changed:?}");
        }
    }
}
