//! Pictures smoothed and resampled, on the host: the same bytes on every machine, by `f64` arithmetic and the functions of
//! `libm`, which are arithmetic themselves. Planes of any number of channels, 8 bits each.

mod gaussian;
mod resample;

pub use gaussian::gaussian;
pub use resample::{about_centre, resample};

/// The nearest grey value, halves up.
pub(crate) fn grey(value: f64) -> u8 {
    (value + 0.5).floor().clamp(0.0, 255.0) as u8
}
