//! Cameras and pairs of cameras: where a point in space appears, and which ray a pixel sees.
//!
//! [`StereoCalibration`] describes a pair as it was taken, with the distortion of its lenses; [`Calibration`] a rectified pair,
//! the geometry that turns disparities into depth. [`crate::rectify::CalibratedRectification`] leads from one to the other. Files are
//! read by [`crate::io::calibration`].

mod camera;
mod monotone;
mod radial_tangential;
mod rectified;
mod stereo;
mod wide;

pub use camera::{CameraModel, Lens};
pub use radial_tangential::RadialTangential;
pub use rectified::{Calibration, depth_map};
pub use stereo::StereoCalibration;
pub use wide::{DoubleSphere, ExtendedUnified, KannalaBrandt, Unified};
