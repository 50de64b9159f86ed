//! The dense half of one pair size: all kernels, all memory, and the order of things.

use std::{sync::OnceLock, time::Duration};

use super::{
    config::{Aggregation, Brightness, DenseConfig, View},
    inputs::Inputs,
    kernels::{MapRows, MapTexel, MapTexture},
    outputs::{Destination, Disparities, Outputs},
    plan::{BandLimits, Plan, blocks, costs},
    readback::MapReadback,
    word_copy::WordCopy,
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    disparity::DisparityMap,
    error::{Error, Result},
    gpu::{
        Dispatch, Gpu, Readback, Stopwatch, buffer_limit, check_buffer, check_limits, check_texture, guarded,
        refused_view, storage_buffer, try_recording,
    },
    image::{Luma, Plane, Size},
    luma::{Input, Source, check_size, kernels::luma_texture::LumaTexture, pack, packed_bytes},
};

/// A disparity for each pixel of the reference view, and how far it can be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    /// Fixed-point disparities; see [`crate::disparity`].
    pub disparity: DisparityMap,
    /// How far a disparity can be trusted, 1 to 255; 0 where there is none, or only what was filled in. Without
    /// refinement it is the margin by which the winner's cost is below its best rival's, as a share of the
    /// rival's; with it, 1 to 245, mostly how many of the pixels around share it, and less where the views look unlike.
    pub confidence: Plane<u8>,
}

impl Dense {
    /// The share of pixels, 0 to 1, whose disparity was measured and not filled in.
    pub fn measured(&self) -> f64 {
        let confidences = self.confidence.data();
        confidences.iter().filter(|&&confidence| confidence > 0).count() as f64 / confidences.len() as f64
    }
}

/// Dense matching of pairs of one size on an application's device.
///
/// It is built once for a size and a configuration; what an application has for it in each frame, textures or buffers, is
/// prepared once as [`Self::inputs`] and [`Self::outputs`], of which there may be as many as it has frames in flight. Then
/// [`Self::record`] goes into an encoder: recording submits nothing, maps nothing, writes no buffer by the queue and creates
/// nothing on the device.
///
/// The disparities that are searched are part of the kernels: for others build another matcher. Only
/// [`Self::set_brightness`] changes what is there.
///
/// Pictures whose planes do not fit in one buffer are matched in bands of rows; no result depends
/// on where they are cut.
#[derive(Debug)]
pub struct Matcher {
    gpu: Gpu,
    size: Size,
    /// Packed luma, left and right.
    luma: [wgpu::Buffer; 2],
    plan: Plan,
    /// Compiled when the first texture needs them.
    luma_texture: OnceLock<LumaTexture>,
    map_textures: [OnceLock<MapTexture>; 2],
}

impl Matcher {
    /// Compiles the kernels and allocates all memory for pairs of `size`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a configuration that cannot be, [`Error::TooLarge`] for a row that
    /// the device cannot bind, [`Error::Unsupported`] for a limit that it lacks, and what the device says.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new(gpu: &Gpu, size: impl Into<Size>, config: &DenseConfig) -> Result<Self> {
        block_on(Self::new_async(gpu, size, config))
    }

    /// As [`Matcher::new`], awaited.
    ///
    /// # Errors
    /// As [`Matcher::new`].
    pub async fn new_async(gpu: &Gpu, size: impl Into<Size>, config: &DenseConfig) -> Result<Self> {
        Self::with_band_rows(gpu, size, config, u32::MAX).await
    }

    /// As [`Self::new`], with at most `band_rows` rows at once: less memory for a little more work.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub async fn with_band_rows(
        gpu: &Gpu,
        size: impl Into<Size>,
        config: &DenseConfig,
        band_rows: u32,
    ) -> Result<Self> {
        Self::build(gpu, size.into(), config, None, band_rows).await
    }

    /// As [`Self::new`], of packed luma that is on the device already.
    pub(crate) async fn with_luma(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        luma: [wgpu::Buffer; 2],
    ) -> Result<Self> {
        Self::build(gpu, size, config, Some(luma), u32::MAX).await
    }

    async fn build(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        luma: Option<[wgpu::Buffer; 2]>,
        band_rows: u32,
    ) -> Result<Self> {
        config.validate()?;
        check_size(size)?;
        check_limits(gpu)?;
        guarded(gpu, "dense matching", || {
            let buffer = |label| storage_buffer(gpu, label, packed_bytes(size));
            let luma = match luma {
                Some(luma) => luma,
                None => [buffer("left luma")?, buffer("right luma")?],
            };
            let views = [&luma[0], &luma[1]];
            let limits = BandLimits { bytes: buffer_limit(gpu), rows: band_rows };
            let plan = match &config.parameters.aggregation {
                Aggregation::Sad { search, .. } => blocks::plan(gpu, size, config, *search, views, limits),
                Aggregation::Costs(costs) => costs::plan(gpu, size, config, costs, views, limits),
            }?;
            let gpu = gpu.clone();
            Ok(Self { gpu, size, luma, plan, luma_texture: OnceLock::new(), map_textures: Default::default() })
        })
        .await
    }

    /// Bytes of device memory that this matcher holds.
    pub fn memory(&self) -> u64 {
        self.luma.iter().map(wgpu::Buffer::size).sum::<u64>() + self.plan.bytes
    }

    /// In how many bands of rows the pair is matched.
    pub fn bands(&self) -> usize {
        self.plan.bands
    }

    /// The packed luma of the left and of the right view (see [`crate::luma`]) that is matched: what [`Self::record`]
    /// writes, and a [`crate::features::Detector`] can read too. Both have `STORAGE`, `COPY_SRC` and
    /// `COPY_DST`.
    pub fn luma(&self) -> [&wgpu::Buffer; 2] {
        self.luma.each_ref()
    }

    /// Prepares the conversion of two views to the matcher's [`Self::luma`]; the inputs hold on to the views.
    ///
    /// # Errors
    /// [`Error::Parameter`] for an invalid size, format or usage; [`Error::Unsupported`] with what else the device has
    /// against it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn inputs(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        block_on(self.inputs_async(left, right))
    }

    /// As [`Matcher::inputs`], awaited.
    ///
    /// # Errors
    /// As [`Matcher::inputs`].
    pub async fn inputs_async(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        let input =
            |name, source, luma| Input::with_kernel(&self.gpu, name, self.size, source, luma, &self.luma_texture);
        let [left_luma, right_luma] = self.luma();
        let left = input("the left view", left, left_luma).await?;
        let right = input("the right view", right, right_luma).await?;
        Ok(Inputs { views: [left, right], of: left_luma.clone() })
    }

    /// Prepares the copies of the results to `disparities` and, if they are wanted, to `confidences`: a buffer with
    /// `COPY_DST` for 0 to 255 per pixel, four per word, in rows of `width.div_ceil(4)` words. The outputs hold on to both.
    ///
    /// # Errors
    /// As [`Self::inputs`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn outputs(&self, disparities: Destination<'_>, confidences: Option<&wgpu::Buffer>) -> Result<Outputs> {
        block_on(self.outputs_async(disparities, confidences))
    }

    /// As [`Matcher::outputs`], awaited.
    ///
    /// # Errors
    /// As [`Matcher::outputs`].
    pub async fn outputs_async(
        &self,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let Size { width, height } = self.size;
        if let Some(buffer) = confidences {
            check_buffer("the confidences", buffer, packed_bytes((width, height)), wgpu::BufferUsages::COPY_DST)?;
        }
        let disparities = match disparities {
            Destination::Buffer(buffer) => {
                let bytes = 4 * u64::from(width) * u64::from(height);
                check_buffer("the disparities", buffer, bytes, wgpu::BufferUsages::COPY_DST)?;
                Disparities::Buffer(buffer.clone())
            }
            Destination::Texture(view) => Disparities::Texture(self.to_texture(view).await?),
        };
        let mut buffers = self.luma.to_vec();
        for (name, buffer) in [("the disparities", disparities.buffer()), ("the confidences", confidences)] {
            let Some(buffer) = buffer else { continue };
            if buffers.contains(buffer) {
                let value = "a buffer that has another use here".into();
                return Err(Error::Resource { name, value, expected: "it needs one of its own".into() });
            }
            buffers.push(buffer.clone());
        }
        let outputs = Outputs { disparities, confidences: confidences.cloned(), of: self.luma[0].clone() };
        try_recording(&self.gpu, "the results", |encoder| self.plan.record(encoder, &outputs, None)).await?;
        Ok(outputs)
    }

    /// What brings each of the plan's answers to a texture.
    async fn to_texture(&self, view: &wgpu::TextureView) -> Result<Vec<Dispatch>> {
        let (name, format) = ("the disparities", view.texture().format());
        let Some(texel) = MapTexel::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", MapTexel::ALL.map(MapTexel::format)),
            });
        };
        check_texture(name, view.texture(), self.size, wgpu::TextureUsages::STORAGE_BINDING)?;
        let stored = &self.map_textures[texel as usize];
        let (kernel, dispatches) = guarded(&self.gpu, name, || {
            let kernel = stored.get().cloned().unwrap_or_else(|| MapTexture::new(&self.gpu, texel));
            let width = self.size.width;
            let dispatch = |answer: &WordCopy| {
                let row = |word: u64| (word / u64::from(width)) as u32;
                let (rows, first_row) = (row(answer.words), row(answer.to_word));
                let rows = MapRows { width, rows, first_word: answer.from_word as u32, first_row };
                kernel.prepare(rows, &answer.from, view)
            };
            let dispatches = self.plan.answers().map(dispatch).collect();
            Ok((kernel, dispatches))
        })
        .await
        .map_err(|error| refused_view(name, error))?;
        // Only now that nothing is wrong with it.
        stored.get_or_init(|| kernel);
        Ok(dispatches)
    }

    /// Changes the right view's brightness from now on, as [`DenseConfig::brightness`] does from the beginning: for what the
    /// queue is given after this. On a lost device nothing changes.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what 32 bits do not hold.
    pub fn set_brightness(&self, brightness: Brightness) -> Result<()> {
        brightness.validate()?;
        self.gpu.queue.write_buffer(&self.plan.brightness(View::Right), 0, bytemuck::bytes_of(&brightness));
        Ok(())
    }

    /// Records the conversion of the inputs to [`Self::luma`] and the matching of the luma. All pixels of the outputs are
    /// overwritten, and nothing else of the outputs. Work recorded twice in one encoder runs twice, one run after the other,
    /// in the same memory.
    ///
    /// # Panics
    /// If `inputs` or `outputs` were prepared for another matcher.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs, outputs: &Outputs) {
        assert_eq!(inputs.of, self.luma[0], "the inputs were prepared for another matcher");
        inputs.views.iter().for_each(|view| view.record(encoder));
        self.record_luma(encoder, outputs);
    }

    /// As [`Self::record`], of the luma that the caller has written to [`Self::luma`].
    ///
    /// # Panics
    /// If `outputs` were prepared for another matcher.
    pub fn record_luma(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs) {
        assert_eq!(outputs.of, self.luma[0], "the outputs were prepared for another matcher");
        self.plan.record(encoder, outputs, None);
    }

    /// Submits the matching of what [`Self::luma`] holds, and waits for the result.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(&self) -> Result<Dense> {
        block_on(self.run_async())
    }

    /// As [`Matcher::run`], awaited.
    ///
    /// # Errors
    /// As [`Matcher::run`].
    pub async fn run_async(&self) -> Result<Dense> {
        self.run_timed(None).await
    }

    /// As [`Self::run`], with what each kernel took by the device's own clock, in the order in which they ran; of the
    /// first 2,048, and without copies and clears.
    ///
    /// # Errors
    /// As [`Self::run`], and [`Error::Unsupported`] without [`wgpu::Features::TIMESTAMP_QUERY`].
    pub async fn profile(&self) -> Result<(Dense, Vec<(&'static str, Duration)>)> {
        let kernels: Vec<_> = self.plan.kernels().collect();
        let stopwatch = guarded(&self.gpu, "timestamps", || Stopwatch::new(&self.gpu, kernels.len())).await?;
        let dense = self.run_timed(Some(&stopwatch)).await?;
        Ok((dense, kernels.into_iter().zip(stopwatch.read(&self.gpu.queue).await?).collect()))
    }

    /// Memory of the host for the map of a frame, prepared once like [`Self::outputs`]; for as many frames in flight there
    /// are as many.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::DeviceLost`].
    pub async fn readback(&self) -> Result<MapReadback> {
        let (gpu, size) = (&self.gpu, self.size);
        let [disparities, confidences] = guarded(gpu, "the disparity map", || {
            let bytes = [4 * u64::from(size.width) * u64::from(size.height), packed_bytes(size)];
            Ok([Readback::new(gpu, "disparities", bytes[0]), Readback::new(gpu, "confidences", bytes[1])])
        })
        .await?;
        let destination = Destination::Buffer(disparities.buffer());
        let outputs = self.outputs_async(destination, Some(confidences.buffer())).await?;
        Ok(MapReadback { size, outputs, disparities, confidences })
    }

    async fn run_timed(&self, stopwatch: Option<&Stopwatch>) -> Result<Dense> {
        let (gpu, readback) = (&self.gpu, self.readback().await?);
        guarded(gpu, "dense matching", || {
            let mut encoder = gpu.encoder("dense");
            self.plan.record(&mut encoder, readback.outputs(), stopwatch);
            if let Some(stopwatch) = stopwatch {
                stopwatch.resolve(&mut encoder);
            }
            gpu.queue.submit([encoder.finish()]);
            Ok(())
        })
        .await?;
        readback.read().await
    }
}

/// Matches one pair on `gpu`.
///
/// # Errors
/// [`Error::SizesDiffer`], and as [`Matcher::new`]; [`Error::DeviceLost`].
pub async fn compute(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> Result<Dense> {
    if left.size() != right.size() {
        return Err(Error::SizesDiffer { left: left.size(), right: right.size() });
    }
    let matcher = Matcher::new_async(gpu, left.size(), config).await?;
    for (view, buffer) in [left, right].into_iter().zip(matcher.luma()) {
        gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&pack(view)));
    }
    matcher.run_async().await
}
