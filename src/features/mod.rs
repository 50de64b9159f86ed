//! The sparse half (paper, steps 2-4): interest points of a picture, each with a descriptor.
//!
//! luma -> integral image -> determinant of the Hessian -> non-maximum suppression -> orientation
//! -> descriptor. Bay, Ess, Tuytelaars, Van Gool: 'Speeded-Up Robust Features (SURF)', CVIU 110,
//! 2008; Evans: 'Notes on the OpenSURF Library', 2009.

pub mod descriptor;
pub mod dispatch;
pub mod hessian;
pub mod integral;
pub mod keypoints;
pub mod nonmax;
pub mod orientation;

mod config;
mod detector;

pub use config::{DESCRIPTOR_LENGTH, Feature, FeatureConfig};
pub use detector::{Detector, detect};

use crate::gpu::Stage;

/// Every stage of the sparse half.
pub fn stages() -> Vec<Stage> {
    vec![
        integral::rows_stage(),
        integral::columns_stage(),
        hessian::stage(1),
        hessian::stage(2),
        nonmax::stage(),
        dispatch::stage(),
        orientation::stage(),
        descriptor::turned_stage(),
        descriptor::upright_stage(),
    ]
}
