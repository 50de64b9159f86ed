//! The unit of disparities, by comparison with another map.

use crate::image::Plane;

/// Ratios of units that occur: fixed point of 4 or 8 bits, sizes of pictures, and scales of grey values.
const RATIOS: [f32; 7] = [1.0, 2.0, 3.0, 4.0, 8.0, 16.0, 256.0];
/// Disparities up to this many pixels tell no unit: those of most scales would agree.
const LEAST_PX: f32 = 1.0;
/// Largest difference of disparities that agree, in pixels, or as a share of the disparity, whichever is more.
const TOLERANCE: [f32; 2] = [1.0, 0.05];
/// Least number of pixels to judge by.
const LEAST_PIXELS: usize = 100;
/// Largest share of pixels that agree as they are, and least share that agrees in another unit, where units differ.
const SHARES: [f64; 2] = [0.25, 0.5];

/// A factor that brings disparities into the unit of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherUnit {
    /// The factor, negative if the signs differ.
    pub scale: f32,
    /// Share of pixels that agree with the map once they are multiplied by the factor, 0 to 1.
    pub agrees: f64,
}

impl OtherUnit {
    /// The factor for `disparities`, if few of them agree with `map` and most do in another unit; otherwise `None`. Both are in pixels, not
    /// finite where unknown, and of one size.
    pub fn of(disparities: &Plane<f32>, map: &Plane<f32>) -> Option<Self> {
        let pairs: Vec<[f32; 2]> =
            disparities.data().iter().zip(map.data()).map(|(&value, &found)| [value, found]).collect();
        let tells = |&[value, found]: &[f32; 2]| value.is_finite() && found.is_finite() && found.abs() > LEAST_PX;
        let pairs: Vec<[f32; 2]> = pairs.into_iter().filter(tells).collect();
        if pairs.len() < LEAST_PIXELS {
            return None;
        }
        let share = |scale: f32| {
            let agrees = |[value, found]: &[f32; 2]| {
                (scale * value - found).abs() <= TOLERANCE[0].max(TOLERANCE[1] * found.abs())
            };
            pairs.iter().filter(|pair| agrees(pair)).count() as f64 / pairs.len() as f64
        };
        let scales = RATIOS.iter().flat_map(|&ratio| [ratio, 1.0 / ratio, -ratio, -1.0 / ratio]);
        let other =
            scales.map(|scale| Self { scale, agrees: share(scale) }).max_by(|a, b| a.agrees.total_cmp(&b.agrees))?;
        (share(1.0) <= SHARES[0] && other.agrees >= SHARES[1]).then_some(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(of: impl Fn(u32) -> f32) -> Plane<f32> {
        Plane::from_fn((40, 10), |x, _| of(x))
    }

    #[test]
    fn signs_and_scales_are_found() {
        let found = map(|x| 20.0 + x as f32);
        for scale in [-1.0, 16.0, 0.0625, -16.0, 256.0, 0.5, 2.0, 1.0 / 3.0, 0.25] {
            let other = OtherUnit::of(&found.map(|d| d / scale), &found).unwrap();
            assert_eq!((other.scale, other.agrees), (scale, 1.0));
        }
    }

    #[test]
    fn what_agrees_or_differs_otherwise_is_in_the_same_unit() {
        let found = map(|x| 20.0 + x as f32);
        for other in [found.clone(), map(|x| 60.0 - x as f32), map(|_| 7.0), map(|x| 1.2 * (20.0 + x as f32))] {
            assert_eq!(OtherUnit::of(&other, &found), None);
        }
        // A third of the pixels agrees as they are.
        let rough = map(|x| if x % 3 == 0 { 20.0 + x as f32 } else { -20.0 - x as f32 });
        assert_eq!(OtherUnit::of(&rough, &found), None);
        assert_eq!(OtherUnit::of(&map(|_| f32::INFINITY), &found), None);
        assert_eq!(OtherUnit::of(&map(|_| 16.0), &map(|_| 1.0)), None, "1 px tells no unit");
    }
}
