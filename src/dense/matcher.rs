//! The matcher of one pair size: kernels, buffers and their plan.

use std::time::Duration;

use super::{
    colours::ReferenceColours,
    config::{Aggregation, Brightness, DenseConfig, FILLED, View},
    inputs::Inputs,
    kernels::{MapRows, MapTexel, MapTexture},
    outputs::{Destination, Disparities, Outputs},
    plan::{BandLimits, Plan, blocks, costs},
    pyramid::Pyramid,
    readback::MapReadback,
    word_copy::WordCopy,
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    disparity::DisparityMap,
    error::{Error, Result, check, check_range},
    gpu::{
        Dispatch, Gpu, Readback, Stopwatch, buffer_limit, check_buffer, check_limits, check_texture, guarded, refused,
        storage_buffer, try_recording, warm_up,
    },
    image::{Plane, Size},
    luma::{Colours, Input, Source, check_size, packed_bytes},
};

/// A disparity map of the reference view, and its confidences.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dense {
    /// Disparities in 1/256 px, or [`crate::disparity::NONE`].
    pub disparity: DisparityMap,
    /// Confidence of each disparity, above [`FILLED`] and up to 255 where it was measured, 1 to [`FILLED`] in filled holes, 0
    /// for no disparity. Without refinement, the margin of the winner's cost below its best rival's, as a share of the rival's
    /// cost. With refinement, up to 245: the number of surrounding pixels with a similar disparity, less where the views differ;
    /// in filled holes, less where the surface that fills it is farther away or differs in colour.
    pub confidence: Plane<u8>,
}

impl Dense {
    /// Share of pixels with a measured disparity, 0 to 1: neither none nor filled.
    pub fn measured(&self) -> f64 {
        let confidences = self.confidence.data();
        confidences.iter().filter(|&&confidence| confidence > FILLED).count() as f64 / confidences.len() as f64
    }
}

/// Dense matching of pairs of one size on an application's device.
///
/// A matcher is built once per size and configuration. [`Self::inputs`] and [`Self::outputs`] bind the application's textures
/// or buffers once; there may be one set per frame in flight. [`Self::record`] records into an encoder per frame: it submits
/// nothing, maps nothing, writes no buffer through the queue and creates nothing on the device.
///
/// The disparity range and all parameters are fixed: a change needs another matcher, which compiles only the kernels that
/// no other matcher of the same [`Gpu`] has. Only the brightness of the right view can change: [`Self::set_brightness`].
///
/// A matcher searches the whole range, or coarse to fine by SAD: what a level of a [`Pyramid`] searches depends on the result
/// of the level above, so that pyramids are matched by [`super::compute`] alone.
///
/// Pairs that exceed the device's buffer limits are matched in bands of rows. The result does not depend on where bands are
/// cut.
#[derive(Debug)]
pub struct Matcher {
    gpu: Gpu,
    size: Size,
    reference: View,
    /// Packed luma, left and right.
    luma: [wgpu::Buffer; 2],
    /// The colours of the reference view, unless the caller has them or they do not matter.
    colours: Option<ReferenceColours>,
    plan: Plan,
}

impl Matcher {
    /// Compiles the kernels that `gpu` does not have yet, and allocates all memory for pairs of `size`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a value of `config` or a `size` outside its range, and where [`Pyramid::of`] has levels; [`Error::TooLarge`] for a row that exceeds
    /// the buffer limits, [`Error::Unsupported`] for a limit that the device lacks, [`Error::OutOfMemory`],
    /// [`Error::DeviceLost`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn new(gpu: &Gpu, size: impl Into<Size>, config: &DenseConfig) -> Result<Self> {
        block_on(Self::new_async(gpu, size, config))
    }

    /// The asynchronous [`Matcher::new`].
    ///
    /// # Errors
    /// See [`Matcher::new`].
    pub async fn new_async(gpu: &Gpu, size: impl Into<Size>, config: &DenseConfig) -> Result<Self> {
        Self::with_band_rows(gpu, size, config, u32::MAX).await
    }

    /// [`Self::new`] with at most `band_rows` rows per band: less memory, a little more work.
    ///
    /// # Errors
    /// See [`Self::new`].
    pub async fn with_band_rows(
        gpu: &Gpu,
        size: impl Into<Size>,
        config: &DenseConfig,
        band_rows: u32,
    ) -> Result<Self> {
        Self::build(gpu, size.into(), config, None, band_rows).await
    }

    /// [`Self::with_band_rows`], for `views` that are on the device, if there are any: packed luma, left and right, and
    /// the colours of the reference view, which must be there where holes are filled.
    pub(super) async fn build(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        views: Option<([wgpu::Buffer; 2], Option<Colours>)>,
        band_rows: u32,
    ) -> Result<Self> {
        config.validate()?;
        check_size(size)?;
        check_range("band_rows", band_rows, 1..=u32::MAX)?;
        check(
            Pyramid::of(config, size).is_none(),
            "the search",
            "coarse to fine over a pyramid",
            "a matcher records before coarse levels have a result: Search::Whole, or dense::compute",
        )?;
        check_limits(gpu)?;
        guarded(gpu, "dense matching", || {
            let buffer = |label| storage_buffer(gpu, label, packed_bytes(size));
            let (luma, given, colours) = match views {
                Some((luma, given)) => (luma, given, None),
                None => {
                    let luma = [buffer("left luma")?, buffer("right luma")?];
                    let colours = ReferenceColours::new(gpu, size, config, luma.each_ref())?;
                    (luma, None, colours)
                }
            };
            let picture = given.as_ref().or(colours.as_ref().map(|own| &own.colours));
            let views = ([&luma[0], &luma[1]], picture);
            let limits = BandLimits { bytes: buffer_limit(gpu), rows: band_rows };
            let plan = match &config.parameters.aggregation {
                Aggregation::Sad { search, compared, .. } => {
                    blocks::plan(gpu, size, config, (*search, *compared), views, limits)
                }
                Aggregation::Costs(costs) => costs::plan(gpu, size, config, costs, views, limits),
            }?;
            Ok(Self { gpu: gpu.clone(), size, reference: config.reference, luma, colours, plan })
        })
        .await
    }

    /// Device memory of this matcher, in bytes.
    pub fn memory(&self) -> u64 {
        let colours = self.colours.as_ref().map_or(0, |own| own.colours.bytes());
        self.luma.iter().map(wgpu::Buffer::size).sum::<u64>() + colours + self.plan.bytes
    }

    /// Number of bands of rows in which a pair is matched.
    pub fn bands(&self) -> usize {
        self.plan.bands
    }

    /// Packed luma of the left and of the right view (see [`crate::luma`]), which [`Self::record`] writes and matches. A
    /// [`crate::Detector`] can read the same buffers. Usages: `STORAGE`, `COPY_SRC`, `COPY_DST`.
    pub fn luma(&self) -> [&wgpu::Buffer; 2] {
        self.luma.each_ref()
    }

    /// Binds two views as inputs of this matcher. The inputs keep the textures or buffers alive.
    ///
    /// # Errors
    /// [`Error::Resource`] for an invalid size, format, usage or dimension, and for a resource of another device.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn inputs(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        block_on(self.inputs_async(left, right))
    }

    /// The asynchronous [`Matcher::inputs`].
    ///
    /// # Errors
    /// See [`Matcher::inputs`].
    pub async fn inputs_async(&self, left: Source<'_>, right: Source<'_>) -> Result<Inputs> {
        let input = |name, source, luma| Input::named(&self.gpu, name, self.size, source, luma);
        for (name, source) in [("the left view", &left), ("the right view", &right)] {
            if let Source::Luma(buffer) = source
                && self.luma.contains(*buffer)
            {
                let value = "the matcher's own luma".into();
                return Err(Error::Resource {
                    name,
                    value,
                    expected: "`record_luma` matches that without inputs".into(),
                });
            }
        }
        let [left_luma, right_luma] = self.luma();
        let views = [input("the left view", left, left_luma).await?, input("the right view", right, right_luma).await?];
        let colours = match (&self.colours, self.reference) {
            (None, _) => None,
            (Some(own), View::Left) => own.input("the left view", &left).await?,
            (Some(own), View::Right) => own.input("the right view", &right).await?,
        };
        Ok(Inputs { views, colours, matcher: left_luma.clone() })
    }

    /// Binds the destination of the disparities and, optionally, a buffer with `COPY_DST` for the confidences: one byte per
    /// pixel, in rows of `width.div_ceil(4)` `u32`s. The outputs keep both alive.
    ///
    /// # Errors
    /// See [`Self::inputs`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn outputs(&self, disparities: Destination<'_>, confidences: Option<&wgpu::Buffer>) -> Result<Outputs> {
        block_on(self.outputs_async(disparities, confidences))
    }

    /// The asynchronous [`Matcher::outputs`].
    ///
    /// # Errors
    /// See [`Matcher::outputs`].
    pub async fn outputs_async(
        &self,
        disparities: Destination<'_>,
        confidences: Option<&wgpu::Buffer>,
    ) -> Result<Outputs> {
        let Size { width, height } = self.size;
        if let Some(buffer) = confidences {
            check_buffer("the confidence map", buffer, packed_bytes((width, height)), wgpu::BufferUsages::COPY_DST)?;
        }
        let disparities = match disparities {
            Destination::Buffer(buffer) => {
                let bytes = 4 * u64::from(width) * u64::from(height);
                check_buffer("the disparity map", buffer, bytes, wgpu::BufferUsages::COPY_DST)?;
                Disparities::Buffer(buffer.clone())
            }
            Destination::Texture(view) => Disparities::Texture(self.to_texture(view).await?),
        };
        let mut buffers = self.luma.to_vec();
        for (name, buffer) in [("the disparity map", disparities.buffer()), ("the confidence map", confidences)] {
            let Some(buffer) = buffer else { continue };
            if buffers.contains(buffer) {
                let value = "a buffer that the matcher also uses for luma or for the other result".into();
                return Err(Error::Resource { name, value, expected: "it needs a buffer of its own".into() });
            }
            buffers.push(buffer.clone());
        }
        let outputs = Outputs { disparities, confidences: confidences.cloned(), matcher: self.luma[0].clone() };
        try_recording(&self.gpu, "the outputs", |encoder| self.plan.record(encoder, &outputs, None))
            .await
            .map_err(|error| refused("the outputs", error))?;
        Ok(outputs)
    }

    /// One dispatch per copy of disparities in the plan, into a texture.
    async fn to_texture(&self, view: &wgpu::TextureView) -> Result<Vec<Dispatch>> {
        let (name, format) = ("the disparity map", view.texture().format());
        let Some(texel) = MapTexel::new(format) else {
            return Err(Error::Resource {
                name,
                value: format!("a texture of format {format:?}"),
                expected: format!("it must be one of {:?}", MapTexel::ALL.map(MapTexel::format)),
            });
        };
        check_texture(name, view.texture(), self.size, wgpu::TextureUsages::STORAGE_BINDING)?;
        guarded(&self.gpu, name, || {
            let kernel = MapTexture::new(&self.gpu, texel);
            let width = self.size.width;
            let dispatch = |copy: &WordCopy| {
                let row = |word: u64| (word / u64::from(width)) as u32;
                let (rows, first_row) = (row(copy.words), row(copy.to_word));
                let rows = MapRows { width, rows, first_word: copy.from_word as u32, first_row };
                kernel.prepare(rows, &copy.from, view)
            };
            Ok(self.plan.copies_of_disparities().map(dispatch).collect())
        })
        .await
        .map_err(|error| refused(name, error))
    }

    /// Replaces [`DenseConfig::brightness`] for everything submitted after this call. No effect on a lost device.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a gain or offset outside its range.
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
        inputs.assert_of(&self.luma[0]);
        outputs.assert_of(&self.luma[0]);
        inputs.views.iter().for_each(|view| view.record(encoder));
        self.colouring(Some(inputs)).iter().for_each(|one| one.record(encoder));
        self.plan.record(encoder, outputs, None);
    }

    /// Records the matching of the luma that the caller has written to [`Self::luma`]. Holes are filled without colours.
    ///
    /// # Panics
    /// If `outputs` were prepared for another matcher.
    pub fn record_luma(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs) {
        outputs.assert_of(&self.luma[0]);
        self.colouring(None).iter().for_each(|one| one.record(encoder));
        self.plan.record(encoder, outputs, None);
    }

    /// What writes the colours of the reference view, if holes are filled: those of `inputs`, or else grey levels.
    fn colouring<'a>(&'a self, inputs: Option<&'a Inputs>) -> &'a [Dispatch] {
        let of_inputs = inputs.and_then(|inputs| inputs.colours.as_deref());
        of_inputs.or(self.colours.as_ref().map(ReferenceColours::grey)).unwrap_or_default()
    }

    /// Compiles what [`Self::record`], or [`Self::record_luma`] without `inputs`, would compile when the device first runs
    /// it, and waits for that: some drivers, among them lavapipe, compile when a kernel first runs. Nothing is computed or
    /// overwritten. Other work that is submitted meanwhile waits, too.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    ///
    /// # Panics
    /// If `inputs` or `outputs` were prepared for another matcher.
    pub async fn warm_up(&self, inputs: Option<&Inputs>, outputs: &Outputs) -> Result<()> {
        if let Some(inputs) = inputs {
            inputs.assert_of(&self.luma[0]);
        }
        outputs.assert_of(&self.luma[0]);
        let colouring = self.colouring(inputs);
        let inputs = inputs.into_iter().flat_map(|inputs| &inputs.views).filter_map(Input::dispatch);
        let matching = self.plan.dispatches().chain(outputs.disparities.dispatches());
        warm_up(&self.gpu, "dense matching", inputs.chain(colouring).chain(matching).collect()).await
    }

    /// Submits the matching of [`Self::luma`], and waits for the result.
    ///
    /// # Errors
    /// [`Error::DeviceLost`], [`Error::OutOfMemory`].
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(&self) -> Result<Dense> {
        block_on(self.run_async())
    }

    /// The asynchronous [`Matcher::run`].
    ///
    /// # Errors
    /// See [`Matcher::run`].
    pub async fn run_async(&self) -> Result<Dense> {
        self.run_timed(None).await
    }

    /// [`Self::run`], submitted part by part, with calls of `progress`.
    pub(super) async fn run_by_parts(&self, progress: impl FnMut(f32)) -> Result<Dense> {
        let mut readback = self.readback().await?;
        self.plan.run_by_parts(readback.outputs(), progress).await?;
        readback.read().await
    }

    /// [`Self::run`] with the duration of each of the first 2,048 kernels by the device's clock, in order of execution;
    /// copies and clears are not timed.
    ///
    /// # Errors
    /// See [`Self::run`]; [`Error::Unsupported`] without [`wgpu::Features::TIMESTAMP_QUERY`].
    pub async fn profile(&self) -> Result<(Dense, Vec<(&'static str, Duration)>)> {
        let kernels: Vec<_> = self.plan.dispatches().map(Dispatch::name).collect();
        let stopwatch = guarded(&self.gpu, "timestamps", || Stopwatch::new(&self.gpu, kernels.len())).await?;
        let dense = self.run_timed(Some(&stopwatch)).await?;
        Ok((dense, kernels.into_iter().zip(stopwatch.read(&self.gpu.queue).await?).collect()))
    }

    /// Allocates staging buffers for the map of one frame; one readback per frame in flight.
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
        let (gpu, mut readback) = (&self.gpu, self.readback().await?);
        guarded(gpu, "dense matching", || {
            let mut encoder = gpu.encoder("dense");
            self.colouring(None).iter().for_each(|one| one.record(&mut encoder));
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
