//! The sparse half (paper, steps 2-4): interest points of a picture, each with a descriptor.
//!
//! luma -> integral image -> determinant of the Hessian -> non-maximum suppression -> orientation
//! -> descriptor. Bay, Ess, Tuytelaars, Van Gool: 'Speeded-Up Robust Features (SURF)', CVIU 110,
//! 2008; Evans: 'Notes on the OpenSURF Library', 2009.

pub mod descriptor;
pub mod hessian;
pub mod integral_columns;
pub mod integral_rows;
pub mod keypoints;
pub mod nonmax;
pub mod orientation;
pub mod workgroups;

mod config;
mod detector;

pub(crate) use config::too_many;
pub use config::{DESCRIPTOR_LENGTH, Feature, FeatureConfig};
#[cfg(not(target_arch = "wasm32"))]
pub use detector::detect;
pub use detector::{Detector, collect, detect_async};

use crate::gpu::Stage;

/// Every stage of the sparse half.
pub fn stages() -> Vec<Stage> {
    vec![
        integral_rows::stage(),
        integral_columns::stage(),
        hessian::stage(true),
        hessian::stage(false),
        nonmax::stage(),
        workgroups::stage(),
        orientation::stage(),
        descriptor::stage(true),
        descriptor::stage(false),
    ]
}
