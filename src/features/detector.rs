//! The detector: all stages of sparse features, for pictures of one size.

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
    readback::FeatureReadback,
};
use crate::{
    error::{Error, Result},
    gpu::{Dispatch, Gpu, Readback, check_limits, guarded, refused, storage_buffer, try_recording},
    image::{Luma, Size},
    luma::{check_packed, check_size, upload},
};

/// Finds and describes the interest points of pictures of one size, with all memory allocated once.
///
/// The results stay on the device, in [`Self::keypoints`] and [`Self::descriptors`], for the application's own kernels.
/// A [`Self::readback`] copies them to the host without waiting; [`Self::read`] copies only as many as were found, and
/// waits.
#[derive(Debug)]
pub struct Detector {
    gpu: Gpu,
    integral: wgpu::Buffer,
    responses: Vec<wgpu::Buffer>,
    list: KeypointList,
    groups: wgpu::Buffer,
    descriptors: wgpu::Buffer,
    size: Size,
    integral_rows: IntegralRows,
    /// All dispatches after the row sums, in order.
    dispatches: Vec<Dispatch>,
}

/// A picture bound to a [`Detector`]: see [`Detector::input`].
#[derive(Debug)]
pub struct DetectorInput {
    dispatch: Dispatch,
    /// Integral image of the detector that the input was prepared for.
    detector: wgpu::Buffer,
}

/// The values of one descriptor.
type Values = [f32; DESCRIPTOR_LENGTH];

impl Detector {
    /// Compiles the kernels and allocates all memory for pictures of `size`.
    ///
    /// The device's adapter needs [`wgpu::DownlevelFlags::INDIRECT_EXECUTION`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if `config` is out of range, [`Error::TooLarge`] if the device cannot bind a
    /// buffer of the size needed, [`Error::OutOfMemory`], [`Error::Unsupported`].
    pub async fn new(gpu: &Gpu, size: impl Into<Size>, config: &FeatureConfig) -> Result<Self> {
        let size = size.into();
        config.validate()?;
        check_size(size)?;
        check_limits(gpu)?;
        guarded(gpu, "finding interest points", || {
            let hessian = Hessian::new(gpu, config);
            let integral = storage_buffer(gpu, "integral image", IntegralRows::bytes(size))?;
            let responses = (0..config.octaves)
                .map(|octave| storage_buffer(gpu, "responses of an octave", hessian.bytes(size, octave)))
                .collect::<Result<Vec<_>>>()?;
            let list = KeypointList::new(gpu, config.max_features)?;
            let groups = Workgroups::groups(gpu);
            let descriptors = storage_buffer(gpu, "descriptors", Descriptor::bytes(&list))?;

            let mut dispatches = vec![IntegralColumns::new(gpu).prepare(size, &integral)];
            let mut finer = None;
            for (octave, responses) in (0..).zip(&responses) {
                dispatches.push(hessian.prepare(size, octave, &integral, finer, responses));
                finer = Some(responses);
            }
            let nonmax = Nonmax::new(gpu);
            let suppression =
                (0..).zip(&responses).map(|(octave, responses)| nonmax.prepare(size, octave, config, responses, &list));
            dispatches.extend(suppression);
            dispatches.push(Workgroups::new(gpu).prepare(&list, &groups));
            if !config.upright {
                dispatches.push(Orientation::new(gpu).prepare(size, &integral, &list, &groups));
            }
            let descriptor = Descriptor::new(gpu, config.upright);
            dispatches.push(descriptor.prepare(size, &integral, &list, &groups, &descriptors));
            let (gpu, integral_rows) = (gpu.clone(), IntegralRows::new(gpu));
            Ok(Self { gpu, integral, responses, list, groups, descriptors, size, integral_rows, dispatches })
        })
        .await
    }

    /// Binds `luma`, a packed picture of the detector's size (see [`crate::luma`]) in a buffer with usage `STORAGE`.
    /// The input keeps the buffer alive.
    ///
    /// # Errors
    /// [`Error::Resource`] if the buffer is too small, lacks the usage or belongs to another device.
    pub async fn input(&self, luma: &wgpu::Buffer) -> Result<DetectorInput> {
        check_packed(luma, self.size)?;
        let prepare = || Ok(self.integral_rows.prepare(self.size, luma, &self.integral));
        let dispatch =
            guarded(&self.gpu, "the picture", prepare).await.map_err(|error| refused("the picture", error))?;
        let input = DetectorInput { dispatch, detector: self.integral.clone() };
        try_recording(&self.gpu, "the picture", |encoder| self.record(encoder, &input))
            .await
            .map_err(|error| refused("the picture", error))?;
        Ok(input)
    }

    /// Detects the features of `luma`: binds it, submits all stages and reads the results.
    ///
    /// # Errors
    /// See [`Self::input`] and [`Self::read`].
    pub async fn detect(&self, luma: &wgpu::Buffer) -> Result<Vec<Feature>> {
        let input = self.input(luma).await?;
        submit(&self.gpu, |encoder| self.record(encoder, &input)).await?;
        self.read().await
    }

    /// Device memory of this detector without the picture, in bytes: mostly that of [`FeatureConfig::max_features`]
    /// descriptors.
    pub fn memory(&self) -> u64 {
        let buffers = [&self.integral, self.list.count(), self.list.keypoints(), &self.groups, &self.descriptors];
        buffers.into_iter().chain(&self.responses).map(wgpu::Buffer::size).sum()
    }

    /// The keypoints and their number.
    pub fn keypoints(&self) -> &KeypointList {
        &self.list
    }

    /// The descriptors: [`DESCRIPTOR_LENGTH`] `f32` per keypoint, in the order of the list.
    pub fn descriptors(&self) -> &wgpu::Buffer {
        &self.descriptors
    }

    /// Records all stages from the integral image of `input` to the descriptors. The previous results are overwritten.
    ///
    /// # Panics
    /// If `input` was prepared for another detector.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, input: &DetectorInput) {
        assert!(input.detector == self.integral, "input of another detector: use this detector's `input`");
        encoder.clear_buffer(self.list.count(), 0, None);
        input.dispatch.record(encoder);
        self.dispatches.iter().for_each(|dispatch| dispatch.record(encoder));
    }

    /// Allocates staging buffers for the features of one frame, for applications that must not wait; allocate one
    /// readback per frame in flight. Its size is that of [`FeatureConfig::max_features`] features, and all of it is
    /// copied.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub async fn readback(&self) -> Result<FeatureReadback> {
        let gpu = &self.gpu;
        guarded(gpu, "the features", || {
            let readback = |label, buffer: &wgpu::Buffer| Readback::new(gpu, label, buffer.size());
            Ok(FeatureReadback {
                capacity: self.list.capacity(),
                detector: self.integral.clone(),
                count: readback("number of keypoints", self.list.count()),
                keypoints: readback("keypoints", self.list.keypoints()),
                descriptors: readback("descriptors", &self.descriptors),
            })
        })
        .await
    }

    /// Records the copy of the features to `readback`, after [`Self::record`].
    ///
    /// # Panics
    /// If `readback` was allocated for another detector.
    pub fn record_readback(&self, encoder: &mut wgpu::CommandEncoder, readback: &FeatureReadback) {
        assert!(readback.detector == self.integral, "readback of another detector: use this detector's `readback`");
        readback.count.record(encoder, self.list.count());
        readback.keypoints.record(encoder, self.list.keypoints());
        readback.descriptors.record(encoder, &self.descriptors);
    }

    /// Waits for the submitted work and returns the features, sorted by octave, layer, row and column.
    ///
    /// Copies only the features found, which takes two submissions.
    ///
    /// # Errors
    /// [`Error::TooManyFeatures`] if more features were found than [`FeatureConfig::max_features`];
    /// [`Error::DeviceLost`].
    pub async fn read(&self) -> Result<Vec<Feature>> {
        let (gpu, list) = (&self.gpu, &self.list);
        let count = submit(gpu, |encoder| {
            let count = Readback::new(gpu, "number of keypoints", size_of::<u32>() as u64);
            count.record(encoder, list.count());
            count
        })
        .await?;
        let keypoint_count = count.read::<u32>(1).await?[0];
        if keypoint_count > list.capacity() {
            return Err(Error::TooManyFeatures { found: keypoint_count as usize, room: list.capacity() });
        }
        if keypoint_count == 0 {
            return Ok(Vec::new());
        }
        let keypoint_count = keypoint_count as usize;
        // Each call has its own staging buffers, so that several threads can read.
        let (keypoints, descriptors) = submit(gpu, |encoder| {
            let keypoints = Readback::new(gpu, "keypoints", (keypoint_count * size_of::<Keypoint>()) as u64);
            let descriptors = Readback::new(gpu, "descriptors", (keypoint_count * size_of::<Values>()) as u64);
            keypoints.record(encoder, list.keypoints());
            descriptors.record(encoder, &self.descriptors);
            (keypoints, descriptors)
        })
        .await?;
        let keypoints = keypoints.read::<Keypoint>(keypoint_count).await?;
        let descriptors = descriptors.read::<Values>(keypoint_count).await?;
        Ok(collect(&keypoints, &descriptors))
    }
}

/// Combines keypoints and their descriptors to features, sorted by octave, layer, row and column.
pub fn collect(keypoints: &[Keypoint], descriptors: &[[f32; DESCRIPTOR_LENGTH]]) -> Vec<Feature> {
    let mut features: Vec<_> = keypoints.iter().zip(descriptors).collect();
    features.sort_unstable_by_key(|(keypoint, _)| keypoint.key());
    features.into_iter().map(|(keypoint, &descriptor)| feature(keypoint, descriptor)).collect()
}

/// Finds and describes the interest points of one picture.
///
/// For several pictures of one size, create a [`Detector`] once.
///
/// # Errors
/// See [`Detector::new`] and [`Detector::read`].
pub async fn detect(gpu: &Gpu, picture: &Luma, config: &FeatureConfig) -> Result<Vec<Feature>> {
    let buffer = upload(gpu, picture).await?;
    Detector::new(gpu, picture.size(), config).await?.detect(&buffer).await
}

/// Submits the commands that `record` encodes, and returns its result.
async fn submit<T>(gpu: &Gpu, record: impl FnOnce(&mut wgpu::CommandEncoder) -> T) -> Result<T> {
    guarded(gpu, "finding interest points", || {
        let mut encoder = gpu.encoder("features");
        let recorded = record(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
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
