//! The CPU twins of the conversion to luma.

#[expect(clippy::module_inception, reason = "a twin has the name of its stage")]
mod luma;
mod luma_texture;

pub use luma::luma;
pub use luma_texture::{Texels, luma_texture};
