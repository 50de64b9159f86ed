//! Rows of the right view: which row of the left view they correspond to, and resampling, so that corresponding points come
//! to lie in the same row.
//!
//! A [`RowModel`] is fitted to matches; a [`CalibratedRectification`] follows from a calibration. Where rows of the right view
//! are not enough and nothing is known of the cameras, [`epipolar`] finds homographies of both views.
//!
//! A [`WarpMap`] says for each pixel of a new picture which position of the source it shows; the kernel `warp` and its twin
//! interpolate there. All arithmetic after the map's construction is in integers: the same bytes on every device.

mod calibrated;
mod catmull_rom;
pub(crate) mod cholesky;
mod climb;
mod curve;
pub mod epipolar;
pub(crate) mod fit;
mod frame;
pub(crate) mod kernels;
mod lens;
mod map;
mod residual;
mod rows;
mod slant;
mod stereo;
mod warp;

pub use calibrated::{CalibratedRectification, RectifiedView};
pub use catmull_rom::SUBPIXEL_BITS;
pub(crate) use catmull_rom::weights;
pub(crate) use climb::Climb;
pub(crate) use frame::AGREEMENT;
pub use frame::Correspondence;
pub(crate) use map::NONE;
pub use map::WarpMap;
pub use residual::Residual;
pub use rows::{RowKind, RowModel};
pub(crate) use slant::Slant;
pub use stereo::StereoRectification;
pub(crate) use warp::{UploadedMap, warp, warp_colours};
