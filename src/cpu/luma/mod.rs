//! The CPU twins of the conversion of pictures.

#[expect(clippy::module_inception, reason = "a twin has the name of its stage")]
mod luma;
mod luma_texture;
mod rgba;
mod rgba_texture;

pub use luma::luma;
pub use luma_texture::{Texels, luma_texture};
pub use rgba::rgba;
pub use rgba_texture::rgba_texture;
