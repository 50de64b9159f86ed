//! The whole sparse half for pictures of one size.

use super::{
    DESCRIPTOR_LENGTH, Feature, FeatureConfig,
    descriptor::Descriptor,
    dispatch::Dispatch,
    hessian::{DETERMINANT_SCALE, Hessian},
    integral::Integral,
    keypoints::{HEADER_BYTES, Keypoint, list_bytes},
    nonmax::Nonmax,
    orientation::Orientation,
};
use crate::{
    error::{Error, Result},
    gpu::{Gpu, Readback, guarded, storage_buffer},
    image::Luma,
    luma,
};

/// Finds and describes the interest points of pictures of one size, with all memory allocated once.
pub struct Detector {
    integral: Integral,
    hessian: Hessian,
    nonmax: Nonmax,
    dispatch: Dispatch,
    /// None in upright mode.
    orientation: Option<Orientation>,
    descriptor: Descriptor,
    /// How many keypoints there are.
    count: Readback,
    max_features: u32,
}

/// The values of one descriptor.
type Values = [f32; DESCRIPTOR_LENGTH];

impl Detector {
    /// Reads `luma`, a packed picture of `width` x `height` (see [`crate::luma`]).
    ///
    /// The device's adapter needs [`wgpu::DownlevelFlags::INDIRECT_EXECUTION`].
    ///
    /// # Errors
    /// [`Error::Parameter`] where `config` is out of range, [`Error::TooLarge`] where the device
    /// cannot bind a buffer of the size needed, [`Error::OutOfMemory`], [`Error::Unsupported`].
    pub fn new(
        device: &wgpu::Device,
        luma: &wgpu::Buffer,
        width: u32,
        height: u32,
        config: &FeatureConfig,
    ) -> Result<Self> {
        config.validate()?;
        guarded(device, "finding interest points", || {
            let integral = Integral::new(device, luma, width, height)?;
            let hessian = Hessian::new(device, integral.integral(), width, height, config)?;
            let nonmax = Nonmax::new(device, &hessian, width, height, config)?;
            let dispatch = Dispatch::new(device, nonmax.list());
            let capacity = config.max_features;
            let orientation = if config.upright {
                None
            } else {
                Some(Orientation::new(device, integral.integral(), nonmax.list(), (width, height), capacity)?)
            };
            let descriptor = Descriptor::new(
                device,
                integral.integral(),
                nonmax.list(),
                orientation.as_ref().map(Orientation::orientations),
                (width, height),
                capacity,
            )?;
            Ok(Self {
                integral,
                hessian,
                nonmax,
                dispatch,
                orientation,
                descriptor,
                count: Readback::new(device, "number of keypoints", HEADER_BYTES),
                max_features: capacity,
            })
        })
    }

    /// Records everything from the integral image to the descriptors.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.integral.record(encoder);
        self.hessian.record(encoder);
        self.nonmax.record(encoder);
        self.dispatch.record(encoder);
        if let Some(orientation) = &self.orientation {
            orientation.record(encoder, self.dispatch.groups());
        }
        self.descriptor.record(encoder, self.dispatch.groups());
        self.count.record(encoder, self.nonmax.list());
    }

    /// Waits for the recorded work, once submitted, and returns what it found, sorted by octave,
    /// layer, row and column.
    ///
    /// Only as much is copied as was found, which takes a submission of its own.
    ///
    /// # Errors
    /// [`Error::Parameter`] where more was found than there is room for; [`Error::DeviceLost`].
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<Feature>> {
        let found = self.count.read::<u32>(device, 1)?[0];
        if found > self.max_features {
            return Err(too_many(found, self.max_features));
        }
        if found == 0 {
            return Ok(Vec::new());
        }
        let found = found as usize;
        let bytes = |each: usize| (found * each) as u64;
        let list = Readback::new(device, "keypoints", list_bytes(found as u32));
        let descriptors = Readback::new(device, "descriptors", bytes(size_of::<Values>()));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("features") });
        list.record(&mut encoder, self.nonmax.list());
        descriptors.record(&mut encoder, self.descriptor.descriptors());
        let orientations = self.orientation.as_ref().map(|orientation| {
            let readback = Readback::new(device, "orientations", bytes(size_of::<f32>()));
            readback.record(&mut encoder, orientation.orientations());
            readback
        });
        queue.submit([encoder.finish()]);
        let list = list.read::<u8>(device, list_bytes(found as u32) as usize)?;
        let keypoints = bytemuck::pod_collect_to_vec::<u8, Keypoint>(&list[HEADER_BYTES as usize..]);
        let descriptors = descriptors.read::<Values>(device, found)?;
        let orientations = match orientations {
            Some(readback) => readback.read::<f32>(device, found)?,
            None => vec![0.0; found],
        };

        let mut order: Vec<_> = (0..found).collect();
        order.sort_unstable_by_key(|&i| keypoints[i].key());
        Ok(order.into_iter().map(|i| feature(&keypoints[i], orientations[i], descriptors[i])).collect())
    }
}

/// Finds and describes the interest points of one picture.
///
/// For more than one picture of a size, a [`Detector`] does the preparations once.
///
/// # Errors
/// Those of [`Detector::new`] and [`Detector::read`].
pub fn detect(gpu: &Gpu, picture: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
    let (width, height) = picture.size();
    let buffer =
        guarded(&gpu.device, "the picture", || storage_buffer(&gpu.device, "luma", luma::packed_bytes(width, height)))?;
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&luma::pack(picture)));
    let detector = Detector::new(&gpu.device, &buffer, width, height, config)?;
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("detect") });
    detector.record(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
    detector.read(&gpu.device, &gpu.queue)
}

fn feature(keypoint: &Keypoint, orientation: f32, descriptor: Values) -> Feature {
    Feature {
        x: keypoint.x,
        y: keypoint.y,
        scale: keypoint.scale,
        response: (f64::from(keypoint.response >> 1) / DETERMINANT_SCALE) as f32,
        dark: keypoint.response & 1 == 1,
        orientation,
        descriptor,
    }
}

fn too_many(found: u32, room: u32) -> Error {
    Error::Parameter {
        name: "max_features",
        value: room.to_string(),
        expected: format!("the picture has {found} interest points: raise max_features, or raise the threshold"),
    }
}
