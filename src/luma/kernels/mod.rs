//! The kernels that make packed luma.

pub mod luma;
pub mod luma_texture;

use crate::gpu::Stage;

/// Every stage that makes luma.
pub fn stages() -> Vec<Stage> {
    vec![luma::stage(), luma_texture::stage()]
}
