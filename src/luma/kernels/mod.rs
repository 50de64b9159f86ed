//! The kernels that convert pictures to packed luma, and to RGBA8 where colours matter.

pub mod luma;
pub mod luma_texture;
pub mod rgba;
pub mod rgba_texture;

use crate::gpu::Stage;

/// Every stage that converts pictures.
pub fn stages() -> Vec<Stage> {
    vec![luma::stage(), luma_texture::stage(), rgba::stage(), rgba_texture::stage()]
}
