//! Matching by the matcher's own submissions, and its map on the host.

use std::time::Duration;

use super::Matcher;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    dense::{
        config::Brightness,
        inputs::Inputs,
        map::Dense,
        outputs::{Destination, Outputs},
        readback::MapReadback,
        uploaded::UploadedPair,
    },
    error::Result,
    gpu::{Dispatch, DispatchSize, Readback, Stopwatch, guarded, warm_up},
    luma::{Input, packed_bytes},
};

impl Matcher {
    /// Compiles what [`Self::record`], or [`Self::record_luma`] without `inputs`, would compile when the device first runs
    /// it, and waits for that: some drivers, among them lavapipe, compile when a kernel first runs. Nothing is computed or
    /// overwritten. Other work that is submitted meanwhile waits, too.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`], [`crate::Error::OutOfMemory`].
    ///
    /// # Panics
    /// If `inputs` or `outputs` were prepared for another matcher.
    pub async fn warm_up(&self, inputs: Option<&Inputs>, outputs: &Outputs) -> Result<()> {
        if let Some(inputs) = inputs {
            inputs.assert_of(&self.pair.luma[0]);
        }
        outputs.assert_of(&self.pair.luma[0]);
        let after_inputs = self.after_inputs(inputs);
        let inputs = inputs.into_iter().flat_map(|inputs| &inputs.views).filter_map(Input::dispatch);
        let matching = self.plan.dispatches().chain(outputs.dispatches());
        warm_up(&self.gpu, "dense matching", inputs.chain(after_inputs).chain(matching).collect()).await
    }

    /// Submits the matching of [`Self::luma`], and waits for the result.
    ///
    /// # Errors
    /// [`crate::Error::DeviceLost`], [`crate::Error::OutOfMemory`].
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
    pub(in crate::dense) async fn run_by_parts(&self, progress: impl FnMut(f32)) -> Result<Dense> {
        self.read_by_parts(&mut self.readback().await?, progress).await
    }

    /// [`Self::run_by_parts`] of another `pair`, whose bytes take the place of this matcher's.
    pub(in crate::dense) async fn run_on(
        &self,
        pair: &UploadedPair,
        brightness: Brightness,
        readback: &mut MapReadback,
        progress: impl FnMut(f32),
    ) -> Result<Dense> {
        self.set_brightness(brightness)?;
        let mut encoder = self.gpu.encoder("the pair");
        pair.copy_to(&self.pair, &mut encoder);
        self.gpu.queue.submit([encoder.finish()]);
        self.read_by_parts(readback, progress).await
    }

    async fn read_by_parts(&self, readback: &mut MapReadback, progress: impl FnMut(f32)) -> Result<Dense> {
        self.plan.run_by_parts(readback.outputs(), progress).await?;
        readback.read().await
    }

    /// [`Self::run`] with the duration of each of the first 2,048 kernels by the device's clock, in order of execution;
    /// copies and clears are not timed.
    ///
    /// # Errors
    /// See [`Self::run`]; [`crate::Error::Unsupported`] without [`wgpu::Features::TIMESTAMP_QUERY`].
    pub async fn profile(&self) -> Result<(Dense, Vec<(&'static str, Duration)>)> {
        let kernels: Vec<_> = self.plan.dispatches().map(Dispatch::name).collect();
        let stopwatch = guarded(&self.gpu, "timestamps", || Stopwatch::new(&self.gpu, kernels.len())).await?;
        let dense = self.run_timed(Some(&stopwatch)).await?;
        Ok((dense, kernels.into_iter().zip(stopwatch.read(&self.gpu.queue).await?).collect()))
    }

    /// The kernels in order of execution, as [`Self::profile`] times them, with their threads and bytes.
    pub fn dispatches(&self) -> Vec<DispatchSize> {
        self.plan.dispatches().map(Dispatch::size).collect()
    }

    /// Allocates staging buffers for the map of one frame; one readback per frame in flight.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`], [`crate::Error::DeviceLost`].
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
            self.after_inputs(None).for_each(|one| one.record(&mut encoder));
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
