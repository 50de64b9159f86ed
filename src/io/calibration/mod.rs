//! Calibration files.
//!
//! [`Calibration`], the geometry of a rectified pair, is always there, with Middlebury's format ([`Calibration::read`]). With the
//! feature `calibrations`, `read` recognises the files of OpenCV, ROS, Kalibr, KITTI, EuRoC, COLMAP and others by their content:
//! see `docs/calibration.md`.

#[cfg(feature = "calibrations")]
mod colmap;
#[cfg(feature = "calibrations")]
mod euroc;
#[cfg(feature = "calibrations")]
mod files;
#[cfg(feature = "calibrations")]
mod kalibr;
#[cfg(feature = "calibrations")]
mod kitti;
#[cfg(feature = "calibrations")]
mod matrices;
mod middlebury;
#[cfg(feature = "calibrations")]
mod numbers;
#[cfg(feature = "calibrations")]
mod opencv;
#[cfg(feature = "calibrations")]
mod own;
#[cfg(feature = "calibrations")]
mod ros;
#[cfg(feature = "calibrations")]
mod tree;
#[cfg(feature = "calibrations")]
mod units;
#[cfg(feature = "calibrations")]
mod xml;
#[cfg(feature = "calibrations")]
mod yaml;

pub use crate::calibration::{Calibration, depth_map};
#[cfg(feature = "calibrations")]
pub use files::{Format, Hints, Loaded, check, parse, read};
#[cfg(feature = "calibrations")]
pub use opencv::to_opencv_yaml;
#[cfg(feature = "calibrations")]
pub use own::to_json;
#[cfg(feature = "recordings")]
pub(crate) use ros::of_infos;

#[cfg(all(test, feature = "calibrations"))]
mod tests;
