//! Orientations, descriptors, and interest points from a picture to their descriptors.

use std::f32::consts::TAU;

use super::tolerances::{ORIENTATIONS, ORIENTATIONS_ANYWHERE, PLACES, descriptors, descriptors_anywhere};
use crate::{
    cpu::features::{
        descriptor::descriptor,
        detector,
        haar::QuantizedPoint,
        integral::IntegralImage,
        orientation::{is_decided, orientation},
    },
    error::Result,
    features::{
        Feature, FeatureConfig, detect,
        kernels::{descriptor::Descriptor, orientation::Orientation, workgroups::Workgroups},
        keypoints::{Keypoint, KeypointList},
    },
    gpu::block_on,
    image::{Luma, Size},
    verify::trial::{Array, Bench, Dice, Subject, Trial},
};

pub(super) const SUBJECTS: &[Subject] = &[
    Subject::kernel("orientation", |size, dice| Box::new(OrientationTrial::draw(size, dice))),
    Subject::kernel("descriptor", |size, dice| Box::new(DescriptorTrial::draw(size, dice))),
    Subject::pipeline("features", |size, dice| Box::new(FeaturesTrial::draw(size, dice))),
];

/// Uploads a list of `keypoints`, and their number of workgroups.
fn list(bench: &Bench<'_>, keypoints: &[Keypoint]) -> Result<(KeypointList, wgpu::Buffer)> {
    let count = keypoints.len() as u32;
    let list = KeypointList::new(bench.gpu, count)?;
    bench.write(list.count(), &[count]);
    bench.write(list.keypoints(), keypoints);
    let groups = Workgroups::groups(bench.gpu);
    let dispatch = Workgroups::new(bench.gpu).prepare(&list, &groups);
    bench.run(|encoder| dispatch.record(encoder));
    Ok((list, groups))
}

/// Draws places in a picture and around it, of any scale and orientation.
fn places_in(Size { width, height }: Size, dice: &mut Dice) -> Vec<Keypoint> {
    let count = 1 + dice.below(400);
    let mut sixty_fourths = |least: f32, length: f32| least + dice.below((64.0 * length) as u32) as f32 / 64.0;
    let keypoint = |_| Keypoint {
        x: sixty_fourths(-4.0, width as f32 + 8.0),
        y: sixty_fourths(-4.0, height as f32 + 8.0),
        scale: sixty_fourths(1.25, 40.0),
        orientation: sixty_fourths(0.0, TAU),
        response: 0,
        octave: 0,
        index: 0,
    };
    (0..count).map(keypoint).collect()
}

/// A column so far outside any picture that no neighbourhood reaches the picture.
const NOTHING_THERE: f32 = -4096.0;

fn keypoint_input(picture: &Luma, keypoints: &[Keypoint]) -> Vec<Array> {
    let places = |k: &Keypoint| [k.x, k.y, k.scale, k.orientation];
    let places: Vec<f32> = keypoints.iter().flat_map(places).collect();
    vec![Array::exact("picture", picture.data().to_vec()), Array::exact("x, y, scale, orientation", places)]
}

fn quantized(keypoint: &Keypoint) -> QuantizedPoint {
    QuantizedPoint::new(keypoint.x, keypoint.y, keypoint.scale)
}

/// Keypoints of a picture that get their orientations.
#[derive(Clone, Debug)]
pub struct OrientationTrial {
    /// The picture.
    pub picture: Luma,
    /// The keypoints.
    pub keypoints: Vec<Keypoint>,
}

impl OrientationTrial {
    /// The keypoints with the device's orientations.
    ///
    /// # Errors
    /// The errors of the device.
    pub fn oriented(&self, bench: &Bench<'_>) -> Result<Vec<Keypoint>> {
        // An orientation that is never written stays NaN.
        let poisoned = |keypoint: &Keypoint| Keypoint { orientation: f32::NAN, ..*keypoint };
        let (list, groups) = list(bench, &self.keypoints.iter().map(poisoned).collect::<Vec<_>>())?;
        let integral = bench.upload(IntegralImage::new(&self.picture).sums().data())?;
        let dispatch = Orientation::new(bench.gpu).prepare(self.picture.size(), &integral, &list, &groups);
        bench.run(|encoder| dispatch.record(encoder));
        bench.download(list.keypoints())
    }

    fn arrays(keypoints: &[Keypoint]) -> Vec<Array> {
        let orientations: Vec<f32> = keypoints.iter().map(|keypoint| keypoint.orientation).collect();
        // The other members of a keypoint do not change.
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
        for keypoint in keypoints.iter_mut().filter(|keypoint| !is_decided(&integral, quantized(keypoint))) {
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
            |keypoint: &Keypoint| Keypoint { orientation: orientation(&integral, quantized(keypoint)), ..*keypoint };
        Ok(Self::arrays(&self.keypoints.iter().map(oriented).collect::<Vec<_>>()))
    }
}

/// Keypoints of a picture that get their descriptors.
#[derive(Clone, Debug)]
pub struct DescriptorTrial {
    /// The picture.
    pub picture: Luma,
    /// The keypoints.
    pub keypoints: Vec<Keypoint>,
    /// Whether descriptors are upright, with axes along the picture instead of the keypoint's orientation.
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
            descriptor(&integral, quantized(keypoint), (!self.upright).then_some(keypoint.orientation))
        };
        Ok(self.arrays(self.keypoints.iter().flat_map(described).collect()))
    }
}

/// A picture whose interest points are found and described.
#[derive(Clone, Debug)]
pub struct FeaturesTrial {
    /// The picture.
    pub picture: Luma,
    /// Parameters of detection.
    pub config: FeatureConfig,
}

impl FeaturesTrial {
    /// Outputs of the trial: samples are exact, places within the last digits of a division, orientations and
    /// descriptors within their tolerances.
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
        Ok(Self::arrays(&block_on(detect(bench.gpu, &self.picture, &self.config))?.features, self.config.upright))
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(Self::arrays(&detector::detect(&self.picture, &self.config)?.features, self.config.upright))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::trials::features::differ;

    /// Orientations that last digits decide are left out of the trial; they must be few.
    #[test]
    fn most_orientations_are_decided() {
        let trial = OrientationTrial::draw(Size::new(311, 239), &mut Dice::new("orientation", 8));
        let left = trial.keypoints.iter().filter(|keypoint| keypoint.x != NOTHING_THERE).count();
        assert!(2 * left > trial.keypoints.len(), "{left} of {}", trial.keypoints.len());
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
