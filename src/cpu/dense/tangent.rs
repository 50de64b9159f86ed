//! Tangent planes of the surfaces beside holes, from the definition.

use crate::{
    dense::kernels::fit::{LEAST_SAMPLES, ROUNDS, SMALL_SHARE, SPECK_SHARES, STEEPEST, STEP, STEPS, TOLERANCE},
    disparity::{DisparityMap, DisparityRange, NONE, SCALE},
    image::{Plane, Size},
};

/// The tangent plane of a surface at one of its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tangent {
    /// Height of the plane at the pixel, in 1/256 px.
    pub height: i32,
    /// Slopes along x and y, in units of 1/256 px per [`crate::dense::kernels::fit::SLOPE_UNITS`] pixels.
    pub slopes: [i32; 2],
    /// Mean colour of the surface at the pixel: red, green, blue.
    pub colour: [u8; 3],
    /// Whether the surface is small: less than one in [`SMALL_SHARE`] of the samples around the pixel belong to it.
    pub is_small: bool,
    /// Whether the pixel belongs to a speck amid holes, where less than one in [`SPECK_SHARES`] of the samples belong to the surface
    /// and have a disparity; or is at an end of the searched range, unless that is 0, and less than the second share belongs to the
    /// surface.
    pub is_doubtful: bool,
}

/// The tangent planes of the pixels that have a disparity and, of their eight neighbours, one without: a plane is fitted where
/// that is one of the neighbours left, right, above and below; a corner has its own disparity and colour, and slopes of 0.
/// `range` was searched.
pub fn tangents(disparities: &DisparityMap, picture: &Plane<[u8; 4]>, range: DisparityRange) -> Plane<Option<Tangent>> {
    let around = |x: u32, y: u32| neighbours(disparities, x, y, 1, 1);
    let holes = |x, y| around(x, y).filter(|&(_, _, other)| other == NONE);
    Plane::from_fn(disparities.size(), |x, y| {
        let own = disparities.get(x, y);
        if own == NONE || holes(x, y).next().is_none() {
            return None;
        }
        let [is_small, is_speck, is_patch] = smallness(disparities, x, y);
        let [low, high] = range.is_at_end(own);
        let is_doubtful = is_speck || is_patch && (low && range.min != 0 || high);
        if holes(x, y).all(|(i, j, _)| i * j != 0) {
            return Some(Tangent { height: own, slopes: [0, 0], colour: rgb(picture, x, y), is_small, is_doubtful });
        }
        let is_surface = |other: i32| other != NONE && (other - own).abs() <= SCALE;
        let surface = around(x, y).filter(|&(_, j, other)| j == 0 && is_surface(other));
        let colours: Vec<_> = surface.map(|(i, _, _)| rgb(picture, x.wrapping_add_signed(i), y)).collect();
        let count = colours.len() as u32;
        let mean = |channel: usize| {
            let sum: u32 = colours.iter().map(|colour| u32::from(colour[channel])).sum();
            ((sum + count / 2) / count) as u8
        };
        let (height, slopes) = plane(disparities, x, y);
        Some(Tangent { height, slopes, colour: [0, 1, 2].map(mean), is_small, is_doubtful })
    })
}

/// Whether the surface at a pixel is small, whether it is a speck amid holes, and whether it is a patch, which at an end of the range
/// is doubtful.
fn smallness(disparities: &DisparityMap, x: u32, y: u32) -> [bool; 3] {
    let own = disparities.get(x, y);
    let samples: Vec<i32> = neighbours(disparities, x, y, STEPS, STEP).map(|(.., other)| other).collect();
    let count = |counts: &dyn Fn(i32) -> bool| samples.iter().filter(|&&other| counts(other)).count() as i32;
    let (surface, known) = (count(&|other| is_sample(other, own)), count(&|other| other != NONE));
    let under = |count: i32, share: i32| share * count < samples.len() as i32;
    let is_speck = under(surface, SPECK_SHARES[0]) && under(known, SPECK_SHARES[1]);
    [under(surface, SMALL_SHARE), is_speck, under(surface, SPECK_SHARES[1])]
}

/// Whether the disparity `other` belongs to the surface of a pixel of the disparity `own`.
fn is_sample(other: i32, own: i32) -> bool {
    other != NONE && (other - own).abs() <= TOLERANCE
}

/// Height and slopes of the plane through the samples around a pixel, by least squares.
fn plane(disparities: &DisparityMap, x: u32, y: u32) -> (i32, [i32; 2]) {
    let own = disparities.get(x, y);
    let samples: Vec<(i32, i32, i32)> = neighbours(disparities, x, y, STEPS, STEP)
        .filter(|&(_, _, other)| is_sample(other, own))
        .map(|(i, j, other)| (i / STEP, j / STEP, other - own))
        .collect();
    let n = samples.len() as i32;
    if n < LEAST_SAMPLES {
        return (own, [0, 0]);
    }
    let sum = |term: fn(&(i32, i32, i32)) -> i32| samples.iter().map(term).sum::<i32>();
    let (u, v, e) = (sum(|s| s.0), sum(|s| s.1), sum(|s| s.2));
    // The normal equations with the mean removed: covariances, times the number of samples.
    let uu = (n * sum(|s| s.0 * s.0) - u * u).div_euclid(n).max(1);
    let uv = (n * sum(|s| s.0 * s.1) - u * v).div_euclid(n);
    let vv = (n * sum(|s| s.1 * s.1) - v * v).div_euclid(n).max(1);
    let ue = rounded_div(n * sum(|s| s.0 * s.2) - u * e, n);
    let ve = rounded_div(n * sum(|s| s.1 * s.2) - v * e, n);
    let [mut along_x, mut along_y] = [0, 0];
    for _ in 0..ROUNDS {
        along_x = rounded_div(16 * ue - along_y * uv, uu).clamp(-STEEPEST[0], STEEPEST[0]);
        along_y = rounded_div(16 * ve - along_x * uv, vv).clamp(-STEEPEST[1], STEEPEST[1]);
    }
    (own + rounded_div(16 * e - u * along_x - v * along_y, 16 * n), [along_x, along_y])
}

/// The nearest integer to a quotient, for a positive divisor.
fn rounded_div(numerator: i32, divisor: i32) -> i32 {
    (numerator + divisor / 2).div_euclid(divisor)
}

/// The pixels of the picture around `(x, y)`, up to `count` on either side in steps of `step`: offset and disparity.
fn neighbours(
    disparities: &DisparityMap,
    x: u32,
    y: u32,
    count: i32,
    step: i32,
) -> impl Iterator<Item = (i32, i32, i32)> {
    let Size { width, height } = disparities.size();
    let offsets = (-count..=count).flat_map(move |j| (-count..=count).map(move |i| (i * step, j * step)));
    offsets.filter_map(move |(i, j)| {
        let (column, row) = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
        (column < width && row < height).then(|| (i, j, disparities.get(column, row)))
    })
}

/// Red, green and blue of a pixel.
pub(super) fn rgb(picture: &Plane<[u8; 4]>, x: u32, y: u32) -> [u8; 3] {
    let [red, green, blue, _] = picture.get(x, y);
    [red, green, blue]
}
