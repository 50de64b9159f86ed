//! The 64-value descriptor with overlapping, Gaussian-weighted subregions (Agrawal, Konolige and
//! Blas, 'CenSurE: Center Surround Extremas', ECCV 2008, section 3.4, made symmetric), on the Haar
//! responses of Bay et al. 2008.

use crate::{
    features::DESCRIPTOR_LENGTH,
    reference::{haar, integral::IntegralImage},
};

/// Samples along each side, a scale apart.
const SAMPLES: usize = 24;
/// Subregions along each side.
const SUBREGIONS: usize = 4;
/// Samples along each side of a subregion, ...
const SUBREGION_SAMPLES: usize = 9;
/// ... and between the starts of neighbouring ones, which hence overlap by 4.
const SUBREGION_STRIDE: usize = 5;
/// Standard deviation of the weights within a subregion, in samples.
const SUBREGION_SIGMA: f32 = 2.5;
/// Standard deviation of the weights of the subregions, in subregions.
const WINDOW_SIGMA: f32 = 1.5;
/// Below this length the surroundings are flat and no direction of the vector means anything.
const FLAT: f32 = 1e-6;

/// Describes the surroundings of `(x, y)`: per subregion, in rows, the sums of dx, dy, |dx|, |dy|.
pub fn describe(integral: &IntegralImage, x: f32, y: f32, scale: f32, orientation: f32) -> [f32; DESCRIPTOR_LENGTH] {
    let gradients = gradients(integral, x, y, scale, orientation);
    let mut descriptor = [0.0; DESCRIPTOR_LENGTH];
    for (index, sums) in descriptor.chunks_mut(4).enumerate() {
        let (row, column) = (index / SUBREGIONS, index % SUBREGIONS);
        let window = weight(row, SUBREGIONS, WINDOW_SIGMA) * weight(column, SUBREGIONS, WINDOW_SIGMA);
        sums.copy_from_slice(&subregion(&gradients, row, column).map(|sum| sum * window));
    }
    normalise(&mut descriptor);
    descriptor
}

/// The gradient at each sample, in the point's own axes.
fn gradients(
    integral: &IntegralImage,
    x: f32,
    y: f32,
    scale: f32,
    orientation: f32,
) -> [[(f32, f32); SAMPLES]; SAMPLES] {
    let (sin, cos) = orientation.sin_cos();
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let (u, v) = (from_centre(column, SAMPLES), from_centre(row, SAMPLES));
            let (sx, sy) = (x + scale * (u * cos - v * sin), y + scale * (u * sin + v * cos));
            let (dx, dy) = haar::responses(integral, sx, sy, scale);
            (cos * dx + sin * dy, cos * dy - sin * dx)
        })
    })
}

/// Weighted sums of dx, dy, |dx|, |dy| over a subregion.
fn subregion(gradients: &[[(f32, f32); SAMPLES]; SAMPLES], row: usize, column: usize) -> [f32; 4] {
    let mut sums = [0.0; 4];
    for j in 0..SUBREGION_SAMPLES {
        for i in 0..SUBREGION_SAMPLES {
            let (dx, dy) = gradients[row * SUBREGION_STRIDE + j][column * SUBREGION_STRIDE + i];
            let weight = weight(i, SUBREGION_SAMPLES, SUBREGION_SIGMA) * weight(j, SUBREGION_SAMPLES, SUBREGION_SIGMA);
            for (sum, value) in sums.iter_mut().zip([dx, dy, dx.abs(), dy.abs()]) {
                *sum += weight * value;
            }
        }
    }
    sums
}

/// Where the `index`-th of `count` evenly spaced places lies, from their middle.
fn from_centre(index: usize, count: usize) -> f32 {
    index as f32 - (count - 1) as f32 / 2.0
}

fn weight(index: usize, count: usize, sigma: f32) -> f32 {
    let distance = from_centre(index, count);
    (-distance * distance / (2.0 * sigma * sigma)).exp()
}

fn normalise(descriptor: &mut [f32; DESCRIPTOR_LENGTH]) {
    let length = descriptor.iter().map(|value| value * value).sum::<f32>().sqrt();
    if length < FLAT {
        descriptor.fill(0.0);
    } else {
        descriptor.iter_mut().for_each(|value| *value /= length);
    }
}
