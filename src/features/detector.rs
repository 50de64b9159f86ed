//! The whole sparse half for pictures of one size.

use super::{
    DESCRIPTOR_LENGTH, Feature, FeatureConfig,
    kernels::{
        descriptor::Descriptor,
        hessian::{DETERMINANT_SCALE, Hessian},
        integral_columns::IntegralColumns,
        integral_rows::IntegralRows,
        nonmax::Nonmax,
        orientation::Orientation,
        workgroups::Workgroups,
    },
    keypoints::{Keypoint, KeypointList},
    too_many,
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::wait;
use crate::{
    error::Result,
    gpu::{Context, Gpu, Readback, check_limits, guarded},
    image::Luma,
    luma::{check_packed, upload},
};

/// Finds and describes the interest points of pictures of one size, with all memory allocated once.
///
/// What it finds stays on the device, in [`Self::keypoints`] and [`Self::descriptors`], for kernels of the application to
/// read, or to be copied from where it does not want to wait: [`collect`] makes [`Feature`]s of the copies. [`Self::read`]
/// does all that at once, and waits.
pub struct Detector {
    rows: IntegralRows,
    columns: IntegralColumns,
    hessian: Hessian,
    nonmax: Nonmax,
    workgroups: Workgroups,
    /// None in upright mode.
    orientation: Option<Orientation>,
    descriptor: Descriptor,
}

/// The values of one descriptor.
type Values = [f32; DESCRIPTOR_LENGTH];

impl Detector {
    /// Reads `luma`, a packed picture of `width` x `height` (see [`crate::luma`]).
    ///
    /// The device's adapter needs [`wgpu::DownlevelFlags::INDIRECT_EXECUTION`].
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] where `config` is out of range, [`crate::Error::TooLarge`] where the device
    /// cannot bind a buffer of the size needed, [`crate::Error::OutOfMemory`], [`crate::Error::Unsupported`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new<'c>(
        device: impl Into<Context<'c>>,
        luma: &wgpu::Buffer,
        width: u32,
        height: u32,
        config: &FeatureConfig,
    ) -> Result<Self> {
        let device = device.into();
        wait(&device, Self::new_async(device, luma, width, height, config))
    }

    /// As [`Detector::new`], without blocking.
    ///
    /// # Errors
    /// As [`Detector::new`].
    pub async fn new_async<'c>(
        device: impl Into<Context<'c>>,
        luma: &wgpu::Buffer,
        width: u32,
        height: u32,
        config: &FeatureConfig,
    ) -> Result<Self> {
        let device = &device.into();
        config.validate()?;
        check_packed(luma, width, height)?;
        check_limits(device)?;
        guarded(device, "finding interest points", || {
            let rows = IntegralRows::new(device, luma, width, height)?;
            let integral = rows.sums();
            let columns = IntegralColumns::new(device, integral, width, height);
            let hessian = Hessian::new(device, integral, width, height, config)?;
            let nonmax = Nonmax::new(device, &hessian, width, height, config)?;
            let list = nonmax.list();
            let workgroups = Workgroups::new(device, list);
            let (groups, size) = (workgroups.groups(), (width, height));
            let orientation = (!config.upright).then(|| Orientation::new(device, integral, list, groups, size));
            let descriptor = Descriptor::new(device, integral, list, groups, size, config.upright)?;
            Ok(Self { rows, columns, hessian, nonmax, workgroups, orientation, descriptor })
        })
        .await
    }

    /// Bytes of device memory that this detector holds, besides the picture: mostly those for
    /// [`FeatureConfig::max_features`] descriptors.
    pub fn memory(&self) -> u64 {
        let list = self.nonmax.list();
        let buffers = [self.rows.sums(), list.found(), list.keypoints(), self.workgroups.groups(), self.descriptors()];
        buffers.map(wgpu::Buffer::size).iter().sum::<u64>() + self.hessian.memory()
    }

    /// How many keypoints were found, and what they are.
    pub fn keypoints(&self) -> &KeypointList {
        self.nonmax.list()
    }

    /// The descriptors: [`DESCRIPTOR_LENGTH`] values of `f32` for each keypoint, in the order of the list.
    pub fn descriptors(&self) -> &wgpu::Buffer {
        self.descriptor.descriptors()
    }

    /// Records everything from the integral image to the descriptors. What was found before is overwritten.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        self.rows.record(encoder);
        self.columns.record(encoder);
        self.hessian.record(encoder);
        self.nonmax.record(encoder);
        self.workgroups.record(encoder);
        if let Some(orientation) = &self.orientation {
            orientation.record(encoder);
        }
        self.descriptor.record(encoder);
    }

    /// Waits for the recorded work, once submitted, and returns what it found, sorted by octave,
    /// layer, row and column.
    ///
    /// Only as much is copied as was found, which takes two submissions.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] where more was found than there is room for; [`crate::Error::DeviceLost`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<Feature>> {
        wait(device, self.read_async(device, queue))
    }

    /// As [`Detector::read`], without blocking.
    ///
    /// # Errors
    /// As [`Detector::read`].
    pub async fn read_async(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<Feature>> {
        let list = self.nonmax.list();
        let count = submit(device, queue, |encoder| {
            let count = Readback::new(device, "number of keypoints", size_of::<u32>() as u64);
            count.record(encoder, list.found());
            count
        })
        .await?;
        let found = count.read::<u32>(1).await?[0];
        if found > list.capacity() {
            return Err(too_many(found as usize, list.capacity()));
        }
        if found == 0 {
            return Ok(Vec::new());
        }
        let found = found as usize;
        // Staging of its own for each call, so that several threads may read.
        let (keypoints, descriptors) = submit(device, queue, |encoder| {
            let keypoints = Readback::new(device, "keypoints", (found * size_of::<Keypoint>()) as u64);
            let descriptors = Readback::new(device, "descriptors", (found * size_of::<Values>()) as u64);
            keypoints.record(encoder, list.keypoints());
            descriptors.record(encoder, self.descriptor.descriptors());
            (keypoints, descriptors)
        })
        .await?;
        let keypoints = keypoints.read::<Keypoint>(found).await?;
        let descriptors = descriptors.read::<Values>(found).await?;
        Ok(collect(&keypoints, &descriptors))
    }
}

/// The features of the keypoints of a list, each with its descriptor, sorted by octave, layer, row and column.
pub fn collect(keypoints: &[Keypoint], descriptors: &[[f32; DESCRIPTOR_LENGTH]]) -> Vec<Feature> {
    let mut features: Vec<_> = keypoints.iter().zip(descriptors).collect();
    features.sort_unstable_by_key(|(keypoint, _)| keypoint.key());
    features.into_iter().map(|(keypoint, &descriptor)| feature(keypoint, descriptor)).collect()
}

/// Finds and describes the interest points of one picture.
///
/// For more than one picture of a size, a [`Detector`] does the preparations once.
///
/// # Errors
/// Those of [`Detector::new`] and [`Detector::read`].
#[cfg(not(target_arch = "wasm32"))]
pub fn detect(gpu: &Gpu, picture: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
    wait(&gpu.device, detect_async(gpu, picture, config))
}

/// As [`detect`], without blocking.
///
/// # Errors
/// As [`detect`].
pub async fn detect_async(gpu: &Gpu, picture: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
    let (width, height) = picture.size();
    let buffer = upload(gpu, picture).await?;
    let detector = Detector::new_async(&gpu.device, &buffer, width, height, config).await?;
    submit(&gpu.device, &gpu.queue, |encoder| detector.record(encoder)).await?;
    detector.read_async(&gpu.device, &gpu.queue).await
}

/// Submits what `record` records; what it returns.
async fn submit<T>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    record: impl FnOnce(&mut wgpu::CommandEncoder) -> T,
) -> Result<T> {
    guarded(device, "finding interest points", || {
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("features") });
        let recorded = record(&mut encoder);
        queue.submit([encoder.finish()]);
        Ok(recorded)
    })
    .await
}

fn feature(keypoint: &Keypoint, descriptor: Values) -> Feature {
    Feature {
        x: keypoint.x,
        y: keypoint.y,
        scale: keypoint.scale,
        response: (f64::from(keypoint.response >> 1) / DETERMINANT_SCALE) as f32,
        dark: keypoint.response & 1 == 1,
        orientation: keypoint.orientation,
        descriptor,
    }
}
