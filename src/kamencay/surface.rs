//! The disparities of a segment: a plane through the disparities of its pixels, on the host.

use crate::disparity::SCALE;

/// Number of fits; each one uses the pixels near the previous plane.
const ROUNDS: usize = 4;

/// Largest distance, in 1/256 px, of a pixel from the median in the first fit, and from the previous plane in later
/// fits.
const FIRST_REACH: i64 = 6 * SCALE as i64;
const REACH: i64 = 3 * SCALE as i64 / 2;

/// Least number of pixels for a slope.
const LEAST_PIXELS: usize = 20;

/// Fixed-point steps per pixel of a plane's coefficients.
const STEPS: i128 = 1 << 14;

/// The steepest slope of a surface that both cameras see, in pixels per pixel.
const STEEPEST: i128 = 2;

/// A pixel and its disparity in whole pixels.
pub(super) type Sample = (u32, u32, i32);

/// A plane of disparities over the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// The pixel at which the plane has `disparity`.
    centre: (i64, i64),
    /// Disparity at `centre`, and its slopes per column and per row, in 1/[`STEPS`] px.
    disparity: i128,
    slopes: (i128, i128),
}

impl Surface {
    /// A plane of constant disparity, in whole pixels.
    fn level(disparity: i32) -> Self {
        Self { centre: (0, 0), disparity: i128::from(disparity) * STEPS, slopes: (0, 0) }
    }

    /// Fits the surface of a segment to its confirmed pixels: the least-squares plane through most of them, or their
    /// lower median if they are few or collinear.
    pub(super) fn of(samples: &[Sample]) -> Option<Self> {
        let mut disparities: Vec<i32> = samples.iter().map(|&(.., disparity)| disparity).collect();
        disparities.sort_unstable();
        let mut surface = Self::level(*disparities.get(disparities.len().saturating_sub(1) / 2)?);
        let mut reach = FIRST_REACH;
        for _ in 0..ROUNDS {
            let near = samples.iter().filter(|sample| surface.distance(sample) <= reach).copied();
            match Self::fit(&near.collect::<Vec<_>>()) {
                Some(next) => surface = next,
                None => break,
            }
            reach = REACH;
        }
        Some(surface)
    }

    /// The disparity at a pixel, in 1/256 px, rounded down.
    pub(super) fn at(&self, x: u32, y: u32) -> i64 {
        let (u, v) = (i64::from(x) - self.centre.0, i64::from(y) - self.centre.1);
        let disparity = self.disparity + self.slopes.0 * i128::from(u) + self.slopes.1 * i128::from(v);
        (disparity * i128::from(SCALE)).div_euclid(STEPS) as i64
    }

    /// The distance of a pixel from the surface, in 1/256 px.
    pub(super) fn distance(&self, &(x, y, disparity): &Sample) -> i64 {
        (i64::from(disparity) * i64::from(SCALE) - self.at(x, y)).abs()
    }

    /// Fits the least-squares plane; `None` if the pixels are few or nearly collinear.
    fn fit(samples: &[Sample]) -> Option<Self> {
        if samples.len() < LEAST_PIXELS {
            return None;
        }
        let n = samples.len() as i64;
        let centre = (
            samples.iter().map(|&(x, ..)| i64::from(x)).sum::<i64>() / n,
            samples.iter().map(|&(_, y, _)| i64::from(y)).sum::<i64>() / n,
        );
        let relative = || samples.iter().map(|&(x, y, d)| [i64::from(x) - centre.0, i64::from(y) - centre.1, d.into()]);
        let sum = |i: usize| i128::from(relative().map(|sample| sample[i]).sum::<i64>());
        let sums = [sum(0), sum(1), sum(2)];
        let count = i128::from(n);
        // Central second moments, times the count.
        let moment = |i: usize, j: usize| {
            let products: i128 = relative().map(|sample| i128::from(sample[i] * sample[j])).sum();
            products - (sums[i] * sums[j]).div_euclid(count)
        };
        let (xx, xy, yy, xd, yd) = (moment(0, 0), moment(0, 1), moment(1, 1), moment(0, 2), moment(1, 2));
        let determinant = xx * yy - xy * xy;
        if determinant <= xx * yy / 1000 {
            return None;
        }
        let slope =
            |numerator: i128| (numerator * STEPS).div_euclid(determinant).clamp(-STEEPEST * STEPS, STEEPEST * STEPS);
        let slopes = (slope(xd * yy - yd * xy), slope(yd * xx - xd * xy));
        let disparity = (sums[2] * STEPS - slopes.0 * sums[0] - slopes.1 * sums[1]).div_euclid(count);
        Some(Self { centre, disparity, slopes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_surface_is_found_among_outliers() {
        // 20 + x / 4 - y / 8 in whole pixels, rounded down; every seventh pixel says 3.
        let truth = |x: u32, y: u32| 20 + (2 * x as i32 - y as i32).div_euclid(8);
        let places = (0..800).map(|i| (i % 40, i / 40));
        let samples: Vec<Sample> =
            places.map(|(x, y)| (x, y, if (x + 3 * y) % 7 == 0 { 3 } else { truth(x, y) })).collect();
        let surface = Surface::of(&samples).unwrap();
        for (x, y) in [(0, 0), (39, 0), (0, 19), (39, 19), (60, 10)] {
            // Rounding down takes 7/16 px off on average.
            let exact = 256 * 20 + 64 * i64::from(x) - 32 * i64::from(y) - 112;
            assert!((surface.at(x, y) - exact).abs() < 40, "({x}, {y}): {}, not {exact}", surface.at(x, y));
        }
    }

    #[test]
    fn few_pixels_and_lines_have_their_median() {
        assert!(Surface::of(&[]).is_none());
        let level = |samples: &[Sample]| {
            let surface = Surface::of(samples).unwrap();
            [surface.at(0, 0), surface.at(500, 90)]
        };
        assert_eq!(level(&[(3, 4, -7)]), [-7 * 256; 2]);
        assert_eq!(level(&[(3, 4, 5), (4, 4, 9), (5, 4, 6), (6, 4, 100)]), [6 * 256; 2]);
        let line: Vec<Sample> = (0..50).map(|x| (x, 3, x as i32)).collect();
        assert_eq!(level(&line), [24 * 256; 2]);
    }
}
