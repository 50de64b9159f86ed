//! Stereo depth from two photographs, on any GPU: every heavy stage is a WGSL compute shader run by
//! [`wgpu`], with a twin on the CPU that ends with the same bytes.
//!
//! On a device of your own, with your own encoder; [`dense::Matcher`] submits nothing:
//!
//! ```
//! use hsad::{dense::{DenseConfig, Matcher}, disparity::DisparityRange, wgpu};
//!
//! /// `left` and `right` hold packed luma (see [`hsad::luma`]); the results are an `i32` disparity in
//! /// 1/256 px and a `u32` confidence a pixel.
//! fn record_disparity(
//!     device: &wgpu::Device,
//!     encoder: &mut wgpu::CommandEncoder,
//!     [left, right]: [&wgpu::Buffer; 2],
//!     [disparities, confidences]: [&wgpu::Buffer; 2],
//! ) -> hsad::Result<()> {
//!     let config = DenseConfig { consistency: Some(256), ..DenseConfig::new(DisparityRange::new(0, 64)?) };
//!     // Once for a size: compiles the kernels, allocates all memory.
//!     let matcher = Matcher::new(device, (640, 480), &config, left, right)?;
//!     // Once a frame.
//!     matcher.record(encoder, disparities, confidences);
//!     Ok(())
//! }
//! ```
//!
//! Or all at once, the disparity range found by itself:
//!
//! ```
//! use hsad::{config::Preset, gpu::DeviceChoice, io::Picture, pair::Backend, pipeline};
//!
//! fn disparity(left: &Picture, right: &Picture) -> hsad::Result<hsad::disparity::DisparityMap> {
//!     let backend = Backend::open(&DeviceChoice::Best)?;
//!     let outcome = pipeline::run(&backend, (left, right), &Preset::Balanced.config(), |_| ())?;
//!     Ok(outcome.dense.disparity)
//! }
//! ```
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
//! [`io`] -> [`gpu`] -> [`features`] -> [`matching`] -> [`seeding`] -> [`dense`] -> [`io`], strung together by
//! [`pipeline`]; where its method is asked for, [`hybrid`] stands in the place of [`dense`]. Each stage has one name in
//! four places: `shaders/<stage>.wgsl`, `src/<half>/<stage>.rs`, `src/reference/<stage>.rs` (its twin) and
//! `tests/kernels/<stage>.rs`.
//!
//! Beside it, [`sparse`] finds the points of one view in another of which nothing is known, and [`eval`] tells how good
//! results are where the truth is known.

pub mod config;
pub mod dense;
pub mod disparity;
pub mod error;
pub mod eval;
pub mod features;
pub mod filter;
pub mod gpu;
pub mod hybrid;
pub mod image;
pub mod input;
pub mod io;
pub mod luma;
pub mod luma_texture;
pub mod matching;
pub mod pair;
pub mod pipeline;
pub mod reference;
pub mod seeding;
pub mod sparse;
#[cfg(feature = "verify")]
pub mod verify;

pub use error::{Error, Result};
pub use wgpu;

/// Every stage there is, for checks that need no GPU.
pub fn stages() -> Vec<gpu::Stage> {
    let mut stages = vec![luma::stage(), luma_texture::stage()];
    stages.extend(features::stages());
    stages.extend(dense::stages());
    stages.extend(hybrid::stages());
    stages
}
