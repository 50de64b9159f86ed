//! The kernels that convert pictures to packed luma.

pub mod luma;
pub mod luma_texture;

use crate::gpu::Stage;

/// Every stage that converts to luma.
pub fn stages() -> Vec<Stage> {
    vec![luma::stage(), luma_texture::stage()]
}
