//! The matcher of one pair size: kernels, buffers and their plan.

mod back;
mod bound;
mod rectifying;
mod resampling;
mod run;

pub(super) use resampling::Views;
use resampling::{Resampling, masks_of};

use super::{
    colours::ReferenceColours,
    config::{Aggregation, Brightness, DenseConfig, View},
    inputs::Inputs,
    outputs::Outputs,
    plan::{BandLimits, Plan, blocks, costs},
    pyramid::Pyramid,
    uploaded::{Masks, UploadedPair},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    error::{Result, check, check_range},
    gpu::{Dispatch, Gpu, buffer_limit, check_limits, guarded, storage_buffer},
    image::Size,
    luma::{check_size, packed_bytes},
    rectify::WarpMap,
};

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
    pair: UploadedPair,
    /// The colours of the reference view, unless the caller has them or they do not matter.
    colours: Option<ReferenceColours>,
    /// What makes the pair of views as they were taken, if it is resampled.
    resampling: Option<Resampling>,
    plan: Plan,
}

impl Matcher {
    /// Compiles the kernels that `gpu` does not have yet, and allocates all memory for pairs of `size`.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a value of `config` or a `size` outside its range, and where [`Pyramid::of`] has levels; [`crate::Error::TooLarge`] for a row that exceeds
    /// the buffer limits, [`crate::Error::Unsupported`] for a limit that the device lacks, [`crate::Error::OutOfMemory`],
    /// [`crate::Error::DeviceLost`].
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
        Self::build(gpu, size.into(), config, Views::Inputs, band_rows).await
    }

    /// [`Self::with_band_rows`], for any `views`.
    pub(super) async fn build(
        gpu: &Gpu,
        size: Size,
        config: &DenseConfig,
        views: Views<'_>,
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
            let allocated = |maps: Option<[&WarpMap; 2]>| -> Result<_> {
                let luma = [buffer("left luma")?, buffer("right luma")?];
                let own = ReferenceColours::new(gpu, size, config, luma.each_ref())?;
                let colours = own.as_ref().map(|own| own.colours.clone());
                let (masks, resampling) = match maps {
                    None => (None, None),
                    Some(maps) => (
                        masks_of(gpu, maps, (config.reference, config.range))?,
                        Some(Resampling::new(gpu, maps, config.reference, &luma, own.as_ref())?),
                    ),
                };
                Ok((UploadedPair { luma, colours, masks }, own, resampling))
            };
            let (pair, colours, resampling) = match views {
                Views::Uploaded(pair) => (pair, None, None),
                Views::Inputs => allocated(None)?,
                Views::Resampled(maps) => allocated(Some(maps))?,
            };
            let limits = BandLimits { bytes: buffer_limit(gpu), rows: band_rows };
            let plan = match &config.parameters.aggregation {
                Aggregation::Sad { search, compared, .. } => {
                    blocks::plan(gpu, size, config, (*search, *compared), &pair, limits)
                }
                Aggregation::Costs(costs) => costs::plan(gpu, size, config, costs, &pair, limits),
            }?;
            Ok(Self { gpu: gpu.clone(), size, reference: config.reference, pair, colours, resampling, plan })
        })
        .await
    }

    /// Device memory of this matcher, in bytes.
    pub fn memory(&self) -> u64 {
        let colours = self.colours.as_ref().map_or(0, |own| own.colours.bytes());
        let masks = self.pair.masks.as_ref().map_or(0, Masks::bytes);
        let resampling = self.resampling.as_ref().map_or(0, Resampling::bytes);
        self.luma().map(wgpu::Buffer::size).iter().sum::<u64>() + colours + masks + resampling + self.plan.bytes
    }

    /// Number of bands of rows in which a pair is matched.
    pub fn bands(&self) -> usize {
        self.plan.bands
    }

    /// Packed luma of the left and of the right view (see [`crate::luma`]), which [`Self::record`] writes and matches. A
    /// [`crate::Detector`] can read the same buffers. Usages: `STORAGE`, `COPY_SRC`, `COPY_DST`.
    pub fn luma(&self) -> [&wgpu::Buffer; 2] {
        self.pair.luma.each_ref()
    }

    /// Replaces [`DenseConfig::brightness`] for everything submitted after this call. No effect on a lost device.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for a gain or offset outside its range.
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
        inputs.assert_of(&self.pair.luma[0]);
        outputs.assert_of(&self.pair.luma[0]);
        inputs.views.iter().for_each(|view| view.record(encoder));
        self.after_inputs(Some(inputs)).for_each(|one| one.record(encoder));
        self.plan.record(encoder, outputs, None);
    }

    /// Records the matching of the luma that the caller has written to [`Self::luma`]. Holes are filled without colours.
    ///
    /// # Panics
    /// If `outputs` were prepared for another matcher.
    pub fn record_luma(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs) {
        outputs.assert_of(&self.pair.luma[0]);
        self.after_inputs(None).for_each(|one| one.record(encoder));
        self.plan.record(encoder, outputs, None);
    }

    /// What follows on the conversion of inputs, if there are any, to luma: the resampling, and what writes the colours of the
    /// reference view, if holes are filled: those of `inputs`, or else grey levels.
    fn after_inputs<'a>(&'a self, inputs: Option<&'a Inputs>) -> impl Iterator<Item = &'a Dispatch> {
        let resampling = inputs.and(self.resampling.as_ref());
        let (luma, of_colours) = match inputs.and_then(|inputs| inputs.colours.as_deref()) {
            Some(colours) => (colours, resampling.map(Resampling::of_colours)),
            None => (self.colours.as_ref().map(ReferenceColours::grey).unwrap_or_default(), None),
        };
        let of_luma = resampling.map(Resampling::of_luma);
        of_luma.into_iter().flatten().chain(luma).chain(of_colours.into_iter().flatten())
    }
}
