//! Smoothing and resampling of pictures, on the host, for planes of any number of 8-bit channels. Results are the same
//! bytes on every machine: only `f64` arithmetic and functions of `libm` are used, which are arithmetic themselves.

mod gaussian;
mod resample;

pub use gaussian::gaussian;
pub use resample::{about_centre, resample};

/// Rounds to the nearest grey value, halves up, and clamps to 0 to 255.
pub(crate) fn grey(value: f64) -> u8 {
    (value + 0.5).floor().clamp(0.0, 255.0) as u8
}
