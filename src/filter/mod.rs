//! Smoothing and resampling of pictures, on the host, for planes of any number of 8-bit channels. Results are the same
//! bytes on every machine: only `f64` arithmetic and functions of `libm` are used, which are arithmetic themselves.

mod detail;
mod gaussian;
mod repetition;
mod resample;

use rayon::prelude::*;

use crate::image::{Plane, Size};

pub(crate) use detail::{CELL, detail};
pub use gaussian::gaussian;
pub(crate) use repetition::repetition;
pub use resample::{about_centre, resample};

/// Rounds to the nearest grey value, halves up, and clamps to 0 to 255.
pub(crate) fn grey(value: f64) -> u8 {
    (value + 0.5).floor().clamp(0.0, 255.0) as u8
}

/// As [`Plane::from_fn`], with rows computed in parallel.
pub(crate) fn in_parallel<T: Clone + Send>(size: Size, value: impl Fn(u32, u32) -> T + Sync) -> Plane<T> {
    let Size { width, height } = size;
    let row = |y| (0..width).map(|x| value(x, y)).collect::<Vec<T>>();
    let rows: Vec<Vec<T>> = (0..height).into_par_iter().map(row).collect();
    Plane::from_fn((width, height), |x, y| rows[y as usize][x as usize].clone())
}
