//! The detector: all stages of sparse features, for pictures of one size.

use super::{
    DESCRIPTOR_LENGTH, Detected, Feature, FeatureConfig,
    kernels::{
        descriptor::Descriptor,
        hessian::{DETERMINANT_SCALE, Grid, Hessian},
        integral_columns::IntegralColumns,
        integral_rows::IntegralRows,
        nonmax::Nonmax,
        orientation::Orientation,
        workgroups::Workgroups,
    },
    keypoints::{Keypoint, KeypointList},
    readback::FeatureReadback,
    strongest::{Ranked, strongest},
};
use crate::{
    error::{Error, Result},
    gpu::{
        Dispatch, Gpu, Readback, check_limits, guarded, record_run, refused, storage_buffer, try_recording, warm_up,
    },
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
    config: FeatureConfig,
    integral_rows: IntegralRows,
    nonmax: Nonmax,
    /// The dispatches after the row sums up to the list of keypoints, in order.
    finding: Vec<Dispatch>,
    /// The dispatches that describe the keypoints of the list, in order.
    describing: Vec<Dispatch>,
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

            let mut finding = vec![IntegralColumns::new(gpu).prepare(size, &integral)];
            let mut finer = None;
            for (octave, responses) in (0..).zip(&responses) {
                finding.push(hessian.prepare(size, octave, &integral, finer, responses));
                finer = Some(responses);
            }
            let nonmax = Nonmax::new(gpu);
            let suppression =
                (0..).zip(&responses).map(|(octave, responses)| nonmax.prepare(size, octave, config, responses, &list));
            finding.extend(suppression);
            let mut describing = vec![Workgroups::new(gpu).prepare(&list, &groups)];
            if !config.upright {
                describing.push(Orientation::new(gpu).prepare(size, &integral, &list, &groups));
            }
            let descriptor = Descriptor::new(gpu, config.upright);
            describing.push(descriptor.prepare(size, &integral, &list, &groups, &descriptors));
            Ok(Self {
                gpu: gpu.clone(),
                integral,
                responses,
                list,
                groups,
                descriptors,
                size,
                config: config.clone(),
                integral_rows: IntegralRows::new(gpu),
                nonmax,
                finding,
                describing,
            })
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

    /// Detects the features of `luma`: binds it, submits all stages and reads the results. Of more features than
    /// [`FeatureConfig::max_features`] the strongest are kept, as said there: the same on every device.
    ///
    /// # Errors
    /// See [`Self::input`]; [`Error::TooLarge`], [`Error::OutOfMemory`] if the device has no room to list all features;
    /// [`Error::DeviceLost`].
    pub async fn detect(&self, luma: &wgpu::Buffer) -> Result<Detected> {
        let input = self.input(luma).await?;
        submit(&self.gpu, |encoder| self.record_finding(encoder, &input)).await?;
        let found = self.count().await?;
        if found > self.list.capacity() {
            self.keep_strongest(found).await?;
        }
        submit(&self.gpu, |encoder| record_run(encoder, &self.describing, None)).await?;
        let features = self.read_listed(found.min(self.list.capacity())).await?;
        Ok(Detected { features, found: found as usize })
    }

    /// Whether this detector finds what one of `size` and `config` does.
    pub(super) fn serves(&self, size: Size, config: &FeatureConfig) -> bool {
        self.size == size && self.config == *config
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
        self.record_finding(encoder, input);
        record_run(encoder, &self.describing, None);
    }

    /// Records the stages from the integral image of `input` to the keypoints.
    fn record_finding(&self, encoder: &mut wgpu::CommandEncoder, input: &DetectorInput) {
        self.assert_own(input);
        encoder.clear_buffer(self.list.count(), 0, None);
        input.dispatch.record(encoder);
        record_run(encoder, &self.finding, None);
    }

    /// Compiles what [`Self::record`] would compile when the device first runs it, and waits for that: see
    /// [`crate::Matcher::warm_up`].
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    ///
    /// # Panics
    /// If `input` was prepared for another detector.
    pub async fn warm_up(&self, input: &DetectorInput) -> Result<()> {
        self.assert_own(input);
        let dispatches = std::iter::once(&input.dispatch).chain(&self.finding).chain(&self.describing).collect();
        warm_up(&self.gpu, "finding interest points", dispatches).await
    }

    fn assert_own(&self, input: &DetectorInput) {
        assert!(input.detector == self.integral, "input of another detector: use this detector's `input`");
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
    /// [`Error::TooManyFeatures`] if more features were found than [`FeatureConfig::max_features`], of which
    /// [`Self::detect`] keeps the strongest; [`Error::DeviceLost`].
    pub async fn read(&self) -> Result<Vec<Feature>> {
        let (found, room) = (self.count().await?, self.list.capacity());
        if found > room {
            return Err(Error::TooManyFeatures { found: found as usize, room });
        }
        self.read_listed(found).await
    }

    /// The number of keypoints found.
    async fn count(&self) -> Result<u32> {
        let gpu = &self.gpu;
        let count = submit(gpu, |encoder| {
            let count = Readback::new(gpu, "number of keypoints", size_of::<u32>() as u64);
            count.record(encoder, self.list.count());
            count
        })
        .await?;
        Ok(count.read::<u32>(1).await?[0])
    }

    /// Puts the strongest of all `found` keypoints into the list, which has no room for all.
    async fn keep_strongest(&self, found: u32) -> Result<()> {
        let (gpu, room) = (&self.gpu, self.list.capacity());
        let (all, keypoints) = guarded(gpu, "finding interest points", || {
            let all = KeypointList::new(gpu, found)?;
            let keypoints = Readback::new(gpu, "keypoints", all.keypoints().size());
            Ok((all, keypoints))
        })
        .await?;
        submit(gpu, |encoder| {
            for (octave, responses) in (0..).zip(&self.responses) {
                self.nonmax.prepare(self.size, octave, &self.config, responses, &all).record(encoder);
            }
            keypoints.record(encoder, all.keypoints());
        })
        .await?;
        let mut keypoints = keypoints.read::<Keypoint>(found as usize).await?;
        keypoints.sort_unstable_by_key(Keypoint::key);
        let ranked: Vec<_> = keypoints.iter().map(|keypoint| ranked(keypoint, self.size, self.config.step)).collect();
        let kept: Vec<_> =
            strongest(&ranked, self.size, room as usize).into_iter().map(|index| keypoints[index]).collect();
        gpu.queue.write_buffer(self.list.count(), 0, bytemuck::bytes_of(&room));
        gpu.queue.write_buffer(self.list.keypoints(), 0, bytemuck::cast_slice(&kept));
        Ok(())
    }

    /// Copies the first `keypoint_count` keypoints of the list and their descriptors to the host.
    async fn read_listed(&self, keypoint_count: u32) -> Result<Vec<Feature>> {
        if keypoint_count == 0 {
            return Ok(Vec::new());
        }
        let (gpu, list, keypoint_count) = (&self.gpu, &self.list, keypoint_count as usize);
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

/// Finds and describes the interest points of one picture; of more than [`FeatureConfig::max_features`] the strongest.
///
/// For several pictures of one size, create a [`Detector`] once.
///
/// # Errors
/// See [`Detector::new`] and [`Detector::detect`].
pub async fn detect(gpu: &Gpu, picture: &Luma, config: &FeatureConfig) -> Result<Detected> {
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

/// Determinant of the Hessian at a keypoint's sample, on OpenSURF's scale.
fn determinant(keypoint: &Keypoint) -> f32 {
    (f64::from(keypoint.response >> 1) / DETERMINANT_SCALE) as f32
}

/// Place and strength of a keypoint's sample in a picture of `size` whose first octave has a sampling step of `step`.
fn ranked(keypoint: &Keypoint, size: Size, step: u32) -> Ranked {
    let grid = Grid::new(size, step, keypoint.octave);
    let place = keypoint.index % (grid.width * grid.height);
    let (i, j) = (place % grid.width, place / grid.width);
    Ranked { x: i * grid.step, y: j * grid.step, response: determinant(keypoint) }
}

fn feature(keypoint: &Keypoint, descriptor: Values) -> Feature {
    Feature {
        x: keypoint.x,
        y: keypoint.y,
        scale: keypoint.scale,
        response: determinant(keypoint),
        dark: keypoint.response & 1 == 1,
        orientation: keypoint.orientation,
        descriptor,
    }
}
