//! The 64-value descriptor: sums of Haar responses in 4x4 subregions (Bay et al. 2008, section 4.2).
//!
//! Three things differ from the paper, all measured on real pairs: a subregion has 2x2 samples, 2 scales apart, instead
//! of 5x5 in 20 scales; gradients are compressed to the cube root of their length, so that one strong edge does not
//! dominate; and wavelets are smaller in upright mode, which distinguishes more places, and larger where their axes are
//! not those of the point.

use crate::{
    cpu::features::{
        haar::{self, QuantizedPoint},
        integral::IntegralImage,
    },
    features::DESCRIPTOR_LENGTH,
};

/// Subregions along each side.
const SUBREGIONS: usize = 4;
/// Samples along each side of a subregion.
const SUBREGION_SAMPLES: usize = 2;
/// Samples along each side of the descriptor.
const SAMPLES: usize = SUBREGIONS * SUBREGION_SAMPLES;
/// Standard deviation of the subregions' Gaussian weights, in subregions.
const SIGMA: f32 = 1.5;
/// Least length of the vector: below it the surroundings are flat and the direction of the vector is meaningless.
const FLAT: f32 = 1e-6;

/// The gradients of all samples, by row and column.
type Gradients = [[(f32, f32); SAMPLES]; SAMPLES];

/// The descriptor at a point: the sums of dx, dy, |dx|, |dy| per subregion, row by row.
///
/// Without an orientation the descriptor is upright, which differs from an orientation of 0.
pub fn descriptor(integral: &IntegralImage, at: QuantizedPoint, orientation: Option<f32>) -> [f32; DESCRIPTOR_LENGTH] {
    let gradients = gradients(integral, at, orientation);
    let mut descriptor = [0.0; DESCRIPTOR_LENGTH];
    for (index, values) in descriptor.chunks_mut(4).enumerate() {
        let (row, column) = (index / SUBREGIONS, index % SUBREGIONS);
        let weight = weight(row, column);
        values.copy_from_slice(&subregion(&gradients, row, column).map(|sum| sum * weight));
    }
    normalise(&mut descriptor);
    descriptor
}

/// The compressed gradients of samples 2 scales apart, in the axes of the point.
fn gradients(integral: &IntegralImage, at: QuantizedPoint, orientation: Option<f32>) -> Gradients {
    let (sin, cos) = orientation.unwrap_or(0.0).sin_cos();
    let scale = at.scale as f32;
    // Side of the wavelets: 1.5 scales upright, else 4.
    let half = if orientation.is_none() { (3 * at.scale + 2) / 4 } else { 2 * at.scale };
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let (u, v) = (from_centre(column), from_centre(row));
            // Exact in upright mode: whole scales in whole sixteenths.
            let x = at.x + (scale * (u * cos - v * sin) + 0.5).floor() as i32;
            let y = at.y + (scale * (u * sin + v * cos) + 0.5).floor() as i32;
            let (dx, dy) = compress(haar::responses(integral, x, y, half));
            (cos * dx + sin * dy, cos * dy - sin * dx)
        })
    })
}

/// Distance of a sample from the middle, in scales: -7, -5, ..., 7.
fn from_centre(index: usize) -> f32 {
    2.0 * index as f32 - (SAMPLES - 1) as f32
}

/// Compresses a vector: the same direction, the cube root of the length.
fn compress((dx, dy): (i32, i32)) -> (f32, f32) {
    if (dx, dy) == (0, 0) {
        return (0.0, 0.0);
    }
    let (dx, dy) = (dx as f32, dy as f32);
    let factor = (dx * dx + dy * dy).powf(-1.0 / 3.0);
    (dx * factor, dy * factor)
}

/// The sums of dx, dy, |dx|, |dy| over a subregion.
fn subregion(gradients: &Gradients, row: usize, column: usize) -> [f32; 4] {
    let mut sums = [0.0; 4];
    for line in &gradients[row * SUBREGION_SAMPLES..][..SUBREGION_SAMPLES] {
        for &(dx, dy) in &line[column * SUBREGION_SAMPLES..][..SUBREGION_SAMPLES] {
            for (sum, value) in sums.iter_mut().zip([dx, dy, dx.abs(), dy.abs()]) {
                *sum += value;
            }
        }
    }
    sums
}

/// The Gaussian weight of a subregion by its distance from the point.
fn weight(row: usize, column: usize) -> f32 {
    let from_centre = |index: usize| index as f32 - (SUBREGIONS - 1) as f32 / 2.0;
    let (r, c) = (from_centre(row), from_centre(column));
    (-(r * r + c * c) / (2.0 * SIGMA * SIGMA)).exp()
}

fn normalise(descriptor: &mut [f32; DESCRIPTOR_LENGTH]) {
    let length = descriptor.iter().map(|value| value * value).sum::<f32>().sqrt();
    if length < FLAT {
        descriptor.fill(0.0);
    } else {
        descriptor.iter_mut().for_each(|value| *value /= length);
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::image::Luma;

    /// Grey values from 20 to 83.
    fn texture(x: u32, y: u32) -> u8 {
        20 + (((x * 7 + y * 3) ^ (x * y / 5)) % 64) as u8
    }

    fn describe_picture(f: impl FnMut(u32, u32) -> u8, (x, y): (f32, f32), orientation: Option<f32>) -> [f32; 64] {
        descriptor(&IntegralImage::new(&Luma::from_fn((81, 81), f)), QuantizedPoint::new(x, y, 2.0), orientation)
    }

    fn distance(a: &[f32; 64], b: &[f32; 64]) -> f32 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()
    }

    #[test]
    fn a_descriptor_has_length_one() {
        let length = distance(&describe_picture(texture, (40.3, 39.8), Some(0.7)), &[0.0; 64]);
        assert!((length - 1.0).abs() < 1e-6, "{length}");
    }

    #[test]
    fn flat_is_all_zeros() {
        assert_eq!(describe_picture(|_, _| 200, (40.0, 40.0), None), [0.0; 64]);
    }

    #[test]
    fn a_ramp_by_hand() {
        // All samples have the same slope, in x only: the four values of a subregion are (w, 0, w, 0), and the length
        // is the root of 2 * sum(w^2).
        let descriptor = describe_picture(|x, _| 2 * x as u8, (40.5, 40.5), None);
        let near = (-0.25f32 / 4.5).exp();
        let far = (-2.25f32 / 4.5).exp();
        let along = 2.0 * (near * near + far * far);
        let corner = far * far / (2.0 * along * along).sqrt();
        let inner = near * near / (2.0 * along * along).sqrt();
        for (index, expected) in [(0, corner), (5, inner)] {
            let values = &descriptor[4 * index..][..4];
            for (value, expected) in values.iter().zip([expected, 0.0, expected, 0.0]) {
                assert!((value - expected).abs() < 1e-5, "{values:?} instead of {expected}");
            }
        }
    }

    #[test]
    fn lengths_become_their_cube_roots() {
        let (dx, dy) = compress((30_000, -40_000));
        // 50000^(1/3) = 36.840.
        assert!((dx - 36.840 * 0.6).abs() < 1e-3 && (dy + 36.840 * 0.8).abs() < 1e-3, "{dx} {dy}");
        assert_eq!(compress((0, 0)), (0.0, 0.0));
    }

    #[test]
    fn gain_and_offset_of_brightness_do_not_matter() {
        for orientation in [None, Some(2.0)] {
            let plain = describe_picture(texture, (40.0, 41.0), orientation);
            let other = describe_picture(|x, y| 2 * texture(x, y) + 60, (40.0, 41.0), orientation);
            assert!(distance(&plain, &other) < 1e-5);
        }
    }

    #[test]
    fn turned_with_its_picture_a_descriptor_stays() {
        let plain = describe_picture(texture, (38.0, 43.0), Some(0.0));
        // A quarter turn takes (x, y) to (80 - y, x).
        let turned = describe_picture(|x, y| texture(y, 80 - x), (37.0, 38.0), Some(FRAC_PI_2));
        assert!(distance(&plain, &turned) < 1e-3, "{}", distance(&plain, &turned));
        let not_turned = describe_picture(|x, y| texture(y, 80 - x), (37.0, 38.0), Some(0.0));
        assert!(distance(&plain, &not_turned) > 0.5);
    }

    #[test]
    fn upright_samples_are_in_their_subregions() {
        // One bright pixel under the sample of row 2, column 7 (5th scale of 2 px right, 3 up, from the centre).
        let (x, y) = (40 + 7 * 2, 40 - 3 * 2);
        let picture = |px, py| if (px, py) == (x + 1, y) { 100 } else { 0 };
        let descriptor = describe_picture(picture, (40.0, 40.0), None);
        let touched: Vec<usize> = (0..16).filter(|index| descriptor[4 * index + 2] != 0.0).collect();
        assert_eq!(touched, [7]);
        assert!(descriptor[4 * 7] > 0.0);
    }
}
