//! Gaussian smoothing.

use super::{grey, in_parallel};
use crate::image::{Plane, Size};

/// Smooths by a Gaussian of standard deviation `sigma` in pixels (0: none), truncated at 3 `sigma`; border pixels are
/// repeated beyond the edge.
pub fn gaussian<const N: usize>(plane: &Plane<[u8; N]>, sigma: f64) -> Plane<[u8; N]> {
    if sigma == 0.0 {
        return plane.clone();
    }
    let reach = (3.0 * sigma).ceil() as i64;
    let weight = |i: i64| libm::exp(-((i * i) as f64) / (2.0 * sigma * sigma));
    let total: f64 = (-reach..=reach).map(weight).sum();
    let weights: Vec<(i64, f64)> = (-reach..=reach).map(|i| (i, weight(i) / total)).collect();

    let Size { width, height } = plane.size();
    let along_rows: Plane<[f64; N]> = in_parallel(Size { width, height }, |x, y| {
        let mut sum = [0.0; N];
        for &(i, weight) in &weights {
            let pixel = plane.get_clamped(i64::from(x) + i, y.into());
            sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += weight * f64::from(value));
        }
        sum
    });
    in_parallel(Size { width, height }, |x, y| {
        let mut sum = [0.0; N];
        for &(i, weight) in &weights {
            let pixel = along_rows.get_clamped(x.into(), i64::from(y) + i);
            sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += weight * value);
        }
        sum.map(grey)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_becomes_a_gaussian() {
        let mut point = Plane::filled((41, 41), [0, 255]);
        point.set(20, 20, [255, 255]);
        let smooth = gaussian(&point, 1.0);
        // 255 / (2 pi) = 40.6 in the middle, exp(-1/2) of that beside it and exp(-1) diagonally.
        let [middle, beside, diagonal] = [(20, 20), (21, 20), (19, 19)].map(|(x, y)| smooth.get(x, y)[0]);
        assert!(middle.abs_diff(41) <= 1 && beside.abs_diff(25) <= 1 && diagonal.abs_diff(15) <= 1);
        assert!(smooth.data().iter().all(|pixel| pixel[1] == 255), "flat channels stay");
        assert_eq!(gaussian(&point, 0.0), point);
    }
}
