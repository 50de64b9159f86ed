//! Stereo depth from two photographs, on any GPU: every heavy stage is a WGSL compute shader run by
//! [`wgpu`], with a twin on the CPU that ends with the same bytes.
//!
//! On a device of your own, from your textures to your texture, in your own encoder; [`dense::Matcher`] submits nothing:
//!
//! ```
//! use hsad::{
//!     config::Preset,
//!     dense::{Brightness, Destination, Inputs, Matcher, Outputs},
//!     disparity::DisparityRange,
//!     luma::Source,
//!     wgpu,
//! };
//!
//! struct Stereo {
//!     matcher: Matcher,
//!     inputs: Inputs,
//!     outputs: Outputs,
//! }
//!
//! impl Stereo {
//!     /// Once for a size: compiles the kernels, allocates all memory. `disparities` is of format R32Float, in pixels.
//!     fn new(
//!         device: &wgpu::Device,
//!         [left, right]: [&wgpu::TextureView; 2],
//!         disparities: &wgpu::TextureView,
//!     ) -> hsad::Result<Self> {
//!         let size = left.texture().size();
//!         let config = Preset::Balanced.dense_config(DisparityRange::new(0, 64)?);
//!         let matcher = Matcher::new(device, (size.width, size.height), &config)?;
//!         let inputs = matcher.inputs(device, Source::Texture(left), Source::Texture(right))?;
//!         let outputs = matcher.outputs(device, Destination::Texture(disparities), None)?;
//!         Ok(Self { matcher, inputs, outputs })
//!     }
//!
//!     /// Once a frame.
//!     fn record(&self, encoder: &mut wgpu::CommandEncoder) {
//!         self.inputs.record(encoder);
//!         self.matcher.record(encoder, &self.outputs);
//!     }
//! }
//! ```
//!
//! [`luma::Source`] says which textures and buffers it takes, [`dense::Destination`] where disparities can go,
//! [`gpu::REQUIRED_LIMITS`] what a device must offer, and [`gpu::Context`] how an application's pipeline cache is used.
//! `examples/embed` draws the disparities, `examples/stream` goes through a sequence of frames.
//!
//! For a sequence, the features of a frame tell the range and the brightness of those after it, without anything having
//! to wait: a [`features::Detector`] reads the matcher's luma, and what it found is copied and looked at when it arrives.
//!
//! ```
//! use hsad::{dense::Matcher, features::Feature, image::Luma, pipeline, seeding::{Seeding, SeedingConfig}, wgpu};
//!
//! /// What a frame's features tell, for the frames after it; the range that a new matcher is needed for, if one is.
//! fn learn(
//!     matcher: &Matcher,
//!     queue: &wgpu::Queue,
//!     views: (&Luma, &Luma),
//!     features: (&[Feature], &[Feature]),
//!     searched: hsad::disparity::DisparityRange,
//! ) -> hsad::Result<Option<hsad::disparity::DisparityRange>> {
//!     let seeding = Seeding::find(views, features, &SeedingConfig::default())?;
//!     if let Some(found) = &seeding.brightness {
//!         matcher.set_brightness(queue, pipeline::equalising(found))?;
//!     }
//!     Ok(seeding.range.ok().filter(|range| range.min < searched.min || range.last() > searched.last()))
//! }
//! ```
//!
//! Or all at once, the disparity range found by itself:
//!
//! ```
//! use hsad::{config::Preset, gpu::DeviceChoice, io::Picture, backend::Backend, pipeline};
//!
//! fn disparity(left: &Picture, right: &Picture) -> hsad::Result<hsad::disparity::DisparityMap> {
//!     let backend = Backend::open(&DeviceChoice::Best)?;
//!     let outcome = pipeline::run(&backend, (left, right), &Preset::Balanced.config(), |_| ())?;
//!     Ok(outcome.dense.disparity)
//! }
//! ```
//!
//! These wait for the device. [`pipeline::run_async`], [`dense::compute_async`] and all others that end in `_async` are
//! awaited instead, in an application's own loop or in a browser, where there are no others:
//!
//! ```
//! # use hsad::{gpu::Gpu, dense::{self, Dense, DenseConfig}, image::Luma};
//! async fn disparity(gpu: &Gpu, left: &Luma, right: &Luma, config: &DenseConfig) -> hsad::Result<Dense> {
//!     dense::compute_async(gpu, left, right, config).await
//! }
//! ```
//!
//! What they wait for natively comes when [`wgpu::Device::poll`] is called, on any thread, or work is submitted.
//!
//! # Conventions
//!
//! - Pixel centres lie at whole numbers, the origin at the top left, x to the right, y down; planes are row-major.
//! - A left pixel `(x, y)` with disparity `d` corresponds to the right pixel `(x - d, y)`; disparities may be negative.
//! - A disparity is an `i32` in 1/256 px ([`disparity::SCALE`]); [`disparity::NONE`] says 'none', 0 is a disparity.
//! - Ties go to the smaller disparity; lists are in raster order of their scale.
//! - The dense half, the integral image, the determinant of the Hessian and the list of interest points are integer
//!   arithmetic: the same bytes on every device and on none. Sub-sample positions, orientations and descriptors are
//!   `f32`, with tolerances stated where they are verified: the feature `verify` holds a device against the twins.
//!
//! # The way through
//!
//! [`io`] or [`luma`] -> [`gpu`] -> [`features`] -> [`matching`] -> [`seeding`] -> [`dense`] -> [`io`], strung together by
//! [`pipeline`]; where its method is asked for, [`kamencay`] stands in the place of [`dense`]. Each stage has one name in
//! four places: `shaders/<stage>.wgsl`, `src/<half>/<stage>.rs`, `src/cpu/<stage>.rs` (its twin) and
//! `tests/kernels/<stage>.rs`.
//!
//! Beside it, [`wide_baseline`] finds the points of one view in another of which nothing is known, and [`eval`] tells how good
//! results are where the truth is known.

pub mod backend;
pub mod config;
pub mod cpu;
pub mod dense;
pub mod disparity;
pub mod error;
pub mod eval;
pub mod features;
pub mod filter;
pub mod gpu;
pub mod image;
pub mod io;
pub mod kamencay;
pub mod luma;
pub mod matching;
mod names;
pub mod pair;
pub mod pipeline;
pub mod seeding;
mod size;
#[cfg(all(feature = "verify", not(target_arch = "wasm32")))]
pub mod verify;
pub mod wide_baseline;

pub use error::{Error, Result};
pub use wgpu;

/// Every stage there is, for checks that need no GPU.
pub fn stages() -> Vec<gpu::Stage> {
    [luma::kernels::stages(), features::kernels::stages(), dense::kernels::stages(), kamencay::kernels::stages()]
        .concat()
}
