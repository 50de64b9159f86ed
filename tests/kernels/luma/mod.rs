//! The kernels of luma.

#[expect(clippy::module_inception, reason = "a test has the name of its stage")]
mod luma;
mod luma_texture;
mod rgba;
mod rgba_texture;
