//! Calibration files.

mod middlebury;

pub use crate::calibration::{Calibration, depth_map};
