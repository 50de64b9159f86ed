//! The dense half of one pair size: all kernels, all memory, and the order of things.

use std::time::Duration;

use super::{
    blocks,
    config::{Aggregation, DenseConfig},
    plan::Plan,
    semi_global,
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::wait;
use crate::{
    disparity::DisparityMap,
    error::{Error, Result},
    gpu::{Gpu, Readback, Stopwatch, guarded},
    image::{Luma, Plane},
    luma::{check_packed, unpack, upload},
};

/// A disparity for each pixel of the reference view, and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    /// Fixed-point disparities; see [`crate::disparity`].
    pub disparity: DisparityMap,
    /// How far a disparity can be trusted, 1 to 255; 0 where there is none, or only what was filled in. Without
    /// refinement it is the margin by which the winner's cost is below its best rival's, as a share of the
    /// rival's; with it, 1 to 245, mostly how many of the pixels around share it.
    pub confidence: Plane<u8>,
}

impl Dense {
    /// The share of pixels, 0 to 1, whose disparity was measured and not filled in.
    pub fn measured(&self) -> f64 {
        let confidences = self.confidence.data();
        confidences.iter().filter(|&&confidence| confidence > 0).count() as f64 / confidences.len() as f64
    }
}

/// Dense matching of pairs of one size on a borrowed device.
///
/// Pictures whose planes do not fit in one buffer are matched in bands of rows; no result depends
/// on where they are cut.
pub struct Matcher {
    size: (u32, u32),
    plan: Plan,
}

impl Matcher {
    /// Compiles the kernels and allocates all memory for packed `left` and `right` of `size`
    /// (rows of `width.div_ceil(4)` words, four pixels a word).
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration that cannot be, [`Error::TooLarge`] for a row that
    /// the device cannot bind, and what the device says.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
    ) -> Result<Self> {
        wait(device, Self::new_async(device, size, config, left, right))
    }

    /// As [`Matcher::new`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::new`].
    pub async fn new_async(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
    ) -> Result<Self> {
        Self::with_band_rows_async(device, size, config, left, right, u32::MAX).await
    }

    /// As [`Self::new`], with at most `band_rows` rows at once: less memory for a little more work.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn with_band_rows(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
        band_rows: u32,
    ) -> Result<Self> {
        wait(device, Self::with_band_rows_async(device, size, config, left, right, band_rows))
    }

    /// As [`Matcher::with_band_rows`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::new`].
    pub async fn with_band_rows_async(
        device: &wgpu::Device,
        size: (u32, u32),
        config: &DenseConfig,
        left: &wgpu::Buffer,
        right: &wgpu::Buffer,
        band_rows: u32,
    ) -> Result<Self> {
        config.validate()?;
        for luma in [left, right] {
            check_packed(luma, size.0, size.1)?;
        }
        // The kernels count words and pixels in 32 bits.
        let limit = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size).min(1 << 32);
        let plan = guarded(device, "dense matching", || match &config.aggregation {
            Aggregation::Window { search, .. } => {
                blocks::plan(device, size, config, *search, [left, right], (limit, band_rows))
            }
            Aggregation::Paths(paths) => {
                semi_global::plan(device, size, config, paths, [left, right], (limit, band_rows))
            }
        })
        .await?;
        Ok(Self { size, plan })
    }

    /// Bytes of device memory that this matcher holds.
    pub fn memory(&self) -> u64 {
        self.plan.bytes
    }

    /// In how many bands of rows the pair is matched.
    pub fn bands(&self) -> usize {
        self.plan.bands
    }

    /// Records the whole matching, which ends with `disparities` (`i32`) and `confidences` (0 to 255,
    /// four a word, in rows of `width.div_ceil(4)` words) of every pixel of the reference view in
    /// the caller's buffers, row by row. Both need `COPY_DST`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, disparities: &wgpu::Buffer, confidences: &wgpu::Buffer) {
        self.plan.record(encoder, disparities, confidences, None);
    }
}

/// Matches one pair on `gpu` and waits for the result.
///
/// # Errors
/// [`Error::SizesDiffer`], and as [`Matcher::new`]; [`Error::DeviceLost`].
#[cfg(not(target_arch = "wasm32"))]
pub fn compute(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    wait(&gpu.device, compute_async(gpu, left, right, config))
}

/// As [`compute`], without blocking.
///
/// # Errors
/// As [`compute`].
pub async fn compute_async(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    let (left_luma, right_luma) = (upload(gpu, left).await?, upload(gpu, right).await?);
    let matcher = Matcher::new_async(&gpu.device, left.size(), config, &left_luma, &right_luma).await?;
    matcher.run_async(gpu).await
}

impl Matcher {
    /// Submits the whole matching on `gpu` and waits for the result.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(&self, gpu: &Gpu) -> Result<Dense> {
        wait(&gpu.device, self.run_async(gpu))
    }

    /// As [`Matcher::run`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::run`].
    pub async fn run_async(&self, gpu: &Gpu) -> Result<Dense> {
        self.run_timed(gpu, None).await
    }

    /// As [`Self::run`], with what each kernel took by the device's own clock, in the order in which they ran; of the
    /// first 2,048, and without copies and clears.
    ///
    /// # Errors
    /// As [`Self::run`], and [`Error::Unsupported`] without [`wgpu::Features::TIMESTAMP_QUERY`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn profile(&self, gpu: &Gpu) -> Result<(Dense, Vec<(&'static str, Duration)>)> {
        wait(&gpu.device, self.profile_async(gpu))
    }

    /// As [`Matcher::profile`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::profile`].
    pub async fn profile_async(&self, gpu: &Gpu) -> Result<(Dense, Vec<(&'static str, Duration)>)> {
        let kernels: Vec<_> = self.plan.kernels().collect();
        let stopwatch = guarded(&gpu.device, "timestamps", || Stopwatch::new(&gpu.device, kernels.len())).await?;
        let dense = self.run_timed(gpu, Some(&stopwatch)).await?;
        Ok((dense, kernels.into_iter().zip(stopwatch.read(gpu).await?).collect()))
    }

    async fn run_timed(&self, gpu: &Gpu, stopwatch: Option<&Stopwatch>) -> Result<Dense> {
        let (width, height) = self.size;
        let pixels = width as usize * height as usize;
        let device = &gpu.device;
        let row_words = width.div_ceil(4) as usize;
        let [disparities, confidences] = guarded(device, "the disparity map", || {
            let lengths = [("disparities", pixels), ("confidences", row_words * height as usize)];
            Ok(lengths.map(|(label, words)| Readback::new(device, label, 4 * words as u64)))
        })
        .await?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("dense") });
        self.plan.record(&mut encoder, disparities.buffer(), confidences.buffer(), stopwatch);
        if let Some(stopwatch) = stopwatch {
            stopwatch.resolve(&mut encoder);
        }
        gpu.queue.submit([encoder.finish()]);
        let disparity = Plane::new(width, height, disparities.read(pixels).await?)?;
        let words: Vec<u32> = confidences.read(row_words * height as usize).await?;
        let confidence = unpack(width, height, &words);
        Ok(Dense { disparity, confidence })
    }
}
