//! Features (paper, steps 2-4): interest points of a picture, each with a descriptor. On a device they are a list of
//! keypoints and a buffer of descriptors.
//!
//! luma -> integral image -> determinant of the Hessian -> non-maximum suppression -> orientation
//! -> descriptor. Bay, Ess, Tuytelaars, Van Gool: 'Speeded-Up Robust Features (SURF)', CVIU 110,
//! 2008; Evans: 'Notes on the OpenSURF Library', 2009.

mod config;
mod detector;
mod kept;
pub(crate) mod kernels;
pub(crate) mod keypoints;
mod readback;
pub(crate) mod strongest;

pub use config::{DESCRIPTOR_LENGTH, Detected, Feature, FeatureConfig};
pub use detector::{Detector, DetectorInput, collect, detect};
pub(crate) use kept::detect_both;
pub use keypoints::{Keypoint, KeypointList};
pub use readback::FeatureReadback;
