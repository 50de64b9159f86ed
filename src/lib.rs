//! Stereo depth from two photographs, on any GPU: every heavy stage is a WGSL compute shader run by [`wgpu`], with a twin
//! on the CPU that computes the same bytes.
//!
//! # A pair of pictures
//!
//! [`pipeline::run`] finds the disparity range itself and computes a map by one of the presets ([`Preset`]) or by a
//! [`Config`] of your own, on a GPU or on the CPU ([`Backend`]):
//!
//! ```
//! use hsad::{Backend, DeviceChoice, DisparityMap, Picture, Preset, pipeline};
//!
//! /// Disparities of the left view, from 8-bit RGBA pixels of a rectified pair.
//! fn disparity(size: (u32, u32), left: &[u8], right: &[u8]) -> hsad::Result<DisparityMap> {
//!     let backend = Backend::open(&DeviceChoice::Best)?;
//!     let (left, right) = (Picture::from_rgba8(size, left)?, Picture::from_rgba8(size, right)?);
//!     let outcome = pipeline::run(&backend, (&left, &right), &Preset::Balanced.config(), |_| ())?;
//!     Ok(outcome.dense.disparity)
//! }
//! ```
//!
//! [`io`] reads and writes files: PNG and JPEG pictures with the feature `pictures`, disparity maps as PFM or PNG, point
//! clouds. [`disparity`] says how a map is stored, [`dense::Dense::confidence`] how far each disparity can be trusted.
//!
//! # Textures of an application
//!
//! A [`Matcher`] works on the application's own device, from its textures or buffers to its textures or buffers, in its own
//! encoder; recording submits nothing and creates nothing:
//!
//! ```
//! use hsad::{
//!     DisparityRange, Gpu, Matcher, Preset,
//!     dense::{Destination, Inputs, Outputs},
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
//!     /// Once per size: compiles the kernels, allocates all memory. `map` has the format R32Float, in pixels.
//!     fn new(gpu: &Gpu, [left, right, map]: [&wgpu::TextureView; 3]) -> hsad::Result<Self> {
//!         let config = Preset::Balanced.dense_config(DisparityRange::new(0, 64)?);
//!         let matcher = Matcher::new(gpu, left.texture().size(), &config)?;
//!         let inputs = matcher.inputs(Source::Texture(left), Source::Texture(right))?;
//!         let outputs = matcher.outputs(Destination::Texture(map), None)?;
//!         Ok(Self { matcher, inputs, outputs })
//!     }
//!
//!     /// Once per frame.
//!     fn record(&self, encoder: &mut wgpu::CommandEncoder) {
//!         self.matcher.record(encoder, &self.inputs, &self.outputs);
//!     }
//! }
//! ```
//!
//! [`Gpu::new`] takes the application's device and queue, [`Gpu::with_cache`] its pipeline cache;
//! [`gpu::REQUIRED_LIMITS`] lists what the device must offer, [`luma::Source`] and [`dense::Destination`] list formats and
//! usages. `examples/embed` draws the map, `examples/stream` follows a sequence of frames.
//!
//! # Interest points
//!
//! A [`Detector`] finds and describes interest points of luma, [`matching`] matches their descriptors, [`seeding`] tells
//! range, brightness and rectification of a pair from the matches, and [`wide_baseline`] matches two views of which
//! nothing is known. In a sequence, the points of one frame tell the range of those after it:
//!
//! ```
//! use hsad::{
//!     DisparityRange, Feature, Luma, Matcher,
//!     seeding::{Seeding, SeedingConfig},
//! };
//!
//! /// Sets the brightness of later frames from this frame, and returns the disparity range of this frame.
//! fn learn(matcher: &Matcher, views: (&Luma, &Luma), points: (&[Feature], &[Feature])) -> hsad::Result<DisparityRange> {
//!     let seeding = Seeding::find(views, points, &SeedingConfig::default())?;
//!     if let Some(relation) = &seeding.brightness {
//!         matcher.set_brightness(relation.equalising())?;
//!     }
//!     Ok(seeding.range?.range)
//! }
//! ```
//!
//! # Scores and errors
//!
//! [`eval`] scores maps and matches where the truth is known. Everything that can go wrong is an [`Error`] with the value,
//! the limit and the way out.
//!
//! # Waiting
//!
//! Functions that wait for a device are `async`. The futures drive the device themselves, so any executor will do;
//! [`block_on`] is the simplest one. The few that most programs begin with also have a blocking form, beside one that ends
//! in `_async`: [`Gpu::open`], [`Backend::open`], [`Matcher::new`], [`Matcher::inputs`], [`Matcher::outputs`],
//! [`Matcher::run`] and [`pipeline::run`]. A browser has the awaited forms alone.
//!
//! # Features of the crate
//!
//! | feature | brings |
//! |---|---|
//! | `backends` | wgpu's Vulkan, Metal and DirectX 12; without it, the application's own wgpu features decide |
//! | `pictures` | reading PNG, JPEG and other picture files, writing maps as PNG |
//! | `calibrations` | reading the calibrations of OpenCV, ROS, Kalibr, KITTI, EuRoC, COLMAP and hsad itself |
//! | `files` | writing files whole or not at all, and reading scenes with their ground truth |
//! | `recordings` | reading pairs of pictures from recordings of robots: MCAP files of ROS |
//! | `reports` | parameters, figures and scores as JSON |
//! | `verify` | the kernels and their twins as a regression suite for a device |
//! | `cli` | the command line, with all of the above |
//!
//! # Conventions
//!
//! - Pixel centres lie at whole numbers, the origin at the top left, x to the right, y down; planes are row-major.
//! - A left pixel `(x, y)` with disparity `d` corresponds to the right pixel `(x - d, y)`; disparities may be negative.
//! - A disparity is an `i32` in 1/256 px ([`disparity::SCALE`]); [`disparity::NONE`] says 'none', 0 is a disparity.
//! - Ties go to the smaller disparity; features are sorted by octave, layer, row and column.
//! - Dense matching, the integral image, the determinant of the Hessian and the list of interest points are integer
//!   arithmetic: the same bytes on every device and on none. Sub-sample positions, orientations and descriptors are `f32`,
//!   with tolerances stated where they are verified.

// Kernels and twins are tried one by one by the regression suite alone.
#![cfg_attr(not(feature = "verify"), allow(dead_code, unused_imports))]

mod backend;
pub mod calibration;
pub mod config;
mod cpu;
pub mod dense;
pub mod disparity;
mod error;
pub mod eval;
pub mod features;
mod filter;
#[cfg(not(target_arch = "wasm32"))]
mod fnv;
pub mod gpu;
pub mod image;
#[cfg(feature = "verify")]
#[doc(hidden)]
pub mod internals;
pub mod io;
pub mod kamencay;
pub mod luma;
mod mask;
pub mod matching;
mod memory;
mod mosaic;
mod names;
pub mod options;
mod pair;
pub mod pipeline;
pub mod rectify;
#[cfg(feature = "reports")]
pub mod report;
pub mod seeding;
mod size;
pub mod tiles;
#[cfg(all(feature = "verify", not(target_arch = "wasm32")))]
pub mod verify;
pub mod wide_baseline;

pub use backend::Backend;
pub use config::{Config, Preset};
pub use dense::{Dense, DenseConfig, Matcher};
pub use disparity::{DisparityMap, DisparityRange};
#[doc(hidden)]
pub use error::shown;
pub use error::{Error, Result};
pub use features::{Detector, Feature, FeatureConfig};
#[cfg(not(target_arch = "wasm32"))]
pub use gpu::block_on;
pub use gpu::{DeviceChoice, Gpu};
pub use image::{Luma, Size};
pub use io::Picture;
pub use options::Options;
pub use pair::Pair;
pub use {glam, wgpu};

/// The Rust of the README and of the page about embedding, compiled.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/embedding.md")]
    struct Embedding;
}
