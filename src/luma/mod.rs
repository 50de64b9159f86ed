//! Luma on the device: one byte per pixel, four packed per `u32`, and the pictures that are converted to it.
//!
//! Pixel `x` of a row is byte `x % 4`, counted from the lowest, of the row's word `x / 4`; a row
//! has `ceil(width / 4)` words, and what lies beyond the width is 0.

mod colours;
mod input;
pub(crate) mod kernels;
mod packed;

pub(crate) use colours::Colours;
pub use input::{Input, Source};
pub use kernels::luma_texture::TexelFormat;
pub use packed::{MAX_SIDE, pack, packed_bytes, unpack};
pub(crate) use packed::{check_packed, check_size, upload};
