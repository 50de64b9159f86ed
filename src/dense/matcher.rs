//! The dense half of one pair size: all kernels, all memory, and the order of things.

use std::{sync::OnceLock, time::Duration};

use super::{
    config::{Aggregation, Brightness, DenseConfig, View},
    inputs::Inputs,
    kernels::{MapRows, MapTexel, MapTexture},
    outputs::{Destination, Disparities, Outputs},
    plan::{Copy, Plan, blocks, semi_global},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::wait;
use crate::{
    disparity::DisparityMap,
    error::{Error, Result},
    gpu::{Context, Dispatch, Gpu, Readback, Stopwatch, check_limits, guarded, storage_buffer},
    image::{Luma, Plane},
    luma::{
        Input, Source, check_buffer, check_size, check_texture, kernels::luma_texture::LumaTexture, pack, packed_bytes,
        try_recording, unpack,
    },
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

/// Dense matching of pairs of one size on a borrowed device.
///
/// It is built once for a size and a configuration; what an application has for it in each frame, textures or buffers, is
/// prepared once as [`Self::inputs`] and [`Self::outputs`], of which there may be as many as it has frames in flight. Then
/// [`Inputs::record`] and [`Self::record`] go into an encoder: they submit nothing, map nothing, write no buffer by the
/// queue and create nothing on the device.
///
/// The disparities that are searched are part of the kernels: for others build another matcher. Only
/// [`Self::set_brightness`] changes what is there.
///
/// Pictures whose planes do not fit in one buffer are matched in bands of rows; no result depends
/// on where they are cut.
pub struct Matcher {
    size: (u32, u32),
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
    pub fn new<'c>(device: impl Into<Context<'c>>, size: (u32, u32), config: &DenseConfig) -> Result<Self> {
        Self::with_band_rows(device, size, config, u32::MAX)
    }

    /// As [`Matcher::new`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::new`].
    pub async fn new_async<'c>(device: impl Into<Context<'c>>, size: (u32, u32), config: &DenseConfig) -> Result<Self> {
        Self::with_band_rows_async(device, size, config, u32::MAX).await
    }

    /// As [`Self::new`], with at most `band_rows` rows at once: less memory for a little more work.
    ///
    /// # Errors
    /// As [`Self::new`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn with_band_rows<'c>(
        device: impl Into<Context<'c>>,
        size: (u32, u32),
        config: &DenseConfig,
        band_rows: u32,
    ) -> Result<Self> {
        let device = device.into();
        wait(&device, Self::with_band_rows_async(device, size, config, band_rows))
    }

    /// As [`Matcher::with_band_rows`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::new`].
    pub async fn with_band_rows_async<'c>(
        device: impl Into<Context<'c>>,
        size: (u32, u32),
        config: &DenseConfig,
        band_rows: u32,
    ) -> Result<Self> {
        let device = &device.into();
        config.validate()?;
        check_size(size.0, size.1)?;
        check_limits(device)?;
        // The kernels count words and pixels in 32 bits.
        let limit = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size).min(1 << 32);
        guarded(device, "dense matching", || {
            let luma = |label| storage_buffer(device, label, packed_bytes(size.0, size.1));
            let luma = [luma("left luma")?, luma("right luma")?];
            let views = [&luma[0], &luma[1]];
            let plan = match &config.aggregation {
                Aggregation::Window { search, .. } => {
                    blocks::plan(device, size, config, *search, views, (limit, band_rows))
                }
                Aggregation::Paths(paths) => semi_global::plan(device, size, config, paths, views, (limit, band_rows)),
            }?;
            Ok(Self { size, luma, plan, luma_texture: OnceLock::new(), map_textures: Default::default() })
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

    /// The packed luma of the left and of the right view (see [`crate::luma`]) that is matched: what [`Inputs::record`]
    /// writes, where it is used, and a [`crate::features::Detector`] can read too. Both have `STORAGE`, `COPY_SRC` and
    /// `COPY_DST`.
    pub fn luma(&self) -> [&wgpu::Buffer; 2] {
        self.luma.each_ref()
    }

    /// Prepares what turns two views into the matcher's [`Self::luma`]; it holds on to them.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a size, a format or a usage that cannot be; [`Error::Unsupported`] with what else the
    /// device has against it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn inputs<'c>(&self, device: impl Into<Context<'c>>, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        let device = device.into();
        wait(&device, self.inputs_async(device, left, right))
    }

    /// As [`Matcher::inputs`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::inputs`].
    pub async fn inputs_async<'c>(
        &self,
        device: impl Into<Context<'c>>,
        left: Source<'_>,
        right: Source<'_>,
    ) -> Result<Inputs> {
        let device = &device.into();
        let input = |name, source, luma| Input::with_kernel(device, name, self.size, source, luma, &self.luma_texture);
        let [left_luma, right_luma] = self.luma();
        let left = input("the left view", left, left_luma).await?;
        Ok(Inputs([left, input("the right view", right, right_luma).await?]))
    }

    /// Prepares the way of the answers to `disparities` and, if they are wanted, to `confidences`: a buffer with
    /// `COPY_DST` for 0 to 255 a pixel, four a word, in rows of `width.div_ceil(4)` words. It holds on to them.
    ///
    /// # Errors
    /// As [`Self::inputs`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn outputs<'c>(
        &self,
        device: impl Into<Context<'c>>,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let device = device.into();
        wait(&device, self.outputs_async(device, disparities, confidences))
    }

    /// As [`Matcher::outputs`], without blocking.
    ///
    /// # Errors
    /// As [`Matcher::outputs`].
    pub async fn outputs_async<'c>(
        &self,
        device: impl Into<Context<'c>>,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let device = &device.into();
        let (width, height) = self.size;
        if let Some(buffer) = confidences {
            check_buffer("the confidences", buffer, packed_bytes(width, height), wgpu::BufferUsages::COPY_DST)?;
        }
        let disparities = match disparities {
            Destination::Buffer(buffer) => {
                let bytes = 4 * u64::from(width) * u64::from(height);
                check_buffer("the disparities", buffer, bytes, wgpu::BufferUsages::COPY_DST)?;
                Disparities::Buffer(buffer.clone())
            }
            Destination::Texture(view) => Disparities::Texture(self.to_texture(device, view).await?),
        };
        let mut buffers = self.luma.to_vec();
        for (name, buffer) in [("the disparities", disparities.buffer()), ("the confidences", confidences)] {
            let Some(buffer) = buffer else { continue };
            if buffers.contains(buffer) {
                let value = "a buffer that has another use here".into();
                return Err(Error::Parameter { name, value, expected: "it needs one of its own".into() });
            }
            buffers.push(buffer.clone());
        }
        let outputs = Outputs { disparities, confidences: confidences.cloned(), of: self.luma[0].clone() };
        try_recording(device, "the results", |encoder| self.plan.record(encoder, &outputs, None)).await?;
        Ok(outputs)
    }

    /// What brings each of the plan's answers to a texture.
    async fn to_texture(&self, device: &Context<'_>, view: &wgpu::TextureView) -> Result<Vec<Dispatch>> {
        let (name, format) = ("the disparities", view.texture().format());
        let Some(texel) = MapTexel::new(format) else {
            return Err(Error::Parameter {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", MapTexel::ALL.map(MapTexel::format)),
            });
        };
        check_texture(name, view.texture(), self.size, wgpu::TextureUsages::STORAGE_BINDING)?;
        let stored = &self.map_textures[texel as usize];
        let (kernel, dispatches) = guarded(device, name, || {
            let kernel = stored.get().cloned().unwrap_or_else(|| MapTexture::new(device, texel));
            let width = self.size.0;
            let dispatch = |answer: &Copy| {
                let row = |word: u64| (word / u64::from(width)) as u32;
                let (rows, first_row) = (row(answer.words), row(answer.to_word));
                let rows = MapRows { width, rows, first_word: answer.from_word as u32, first_row };
                kernel.prepare(device, rows, &answer.from, view)
            };
            let dispatches = self.plan.answers().map(dispatch).collect();
            Ok((kernel, dispatches))
        })
        .await?;
        // Only now that nothing is wrong with it.
        stored.get_or_init(|| kernel);
        Ok(dispatches)
    }

    /// Changes the right view's brightness from now on, as [`DenseConfig::brightness`] does from the beginning: for what
    /// `queue`, that of the matcher's device, is given after this. That of another device, or of one that is lost, changes
    /// nothing; wgpu tells the former to its handler of uncaptured errors.
    ///
    /// # Errors
    /// [`Error::Parameter`] for what 32 bits do not hold.
    pub fn set_brightness(&self, queue: &wgpu::Queue, brightness: Brightness) -> Result<()> {
        brightness.validate()?;
        queue.write_buffer(&self.plan.brightness(View::Right), 0, bytemuck::bytes_of(&brightness));
        Ok(())
    }

    /// Records the matching of what [`Self::luma`] holds then; all pixels of the outputs are overwritten, and nothing
    /// else of them. Recorded twice in one encoder, it is done twice, one after the other, in the same memory.
    ///
    /// # Panics
    /// If `outputs` were prepared for another matcher.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs) {
        assert_eq!(outputs.of, self.luma[0], "outputs of another matcher");
        self.plan.record(encoder, outputs, None);
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
    let matcher = Matcher::new_async(&gpu.device, left.size(), config).await?;
    for (view, buffer) in [left, right].into_iter().zip(matcher.luma()) {
        gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&pack(view)));
    }
    matcher.run_async(gpu).await
}

impl Matcher {
    /// Submits the matching of what [`Self::luma`] holds on `gpu`, and waits for the result.
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
        let destination = Destination::Buffer(disparities.buffer());
        let outputs = self.outputs_async(device, destination, Some(confidences.buffer())).await?;
        guarded(device, "dense matching", || {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("dense") });
            self.plan.record(&mut encoder, &outputs, stopwatch);
            if let Some(stopwatch) = stopwatch {
                stopwatch.resolve(&mut encoder);
            }
            gpu.queue.submit([encoder.finish()]);
            Ok(())
        })
        .await?;
        let disparity = Plane::new(width, height, disparities.read(pixels).await?)?;
        let words: Vec<u32> = confidences.read(row_words * height as usize).await?;
        let confidence = unpack(width, height, &words);
        Ok(Dense { disparity, confidence })
    }
}
