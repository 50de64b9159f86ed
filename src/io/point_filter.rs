//! Which pixels of a map become points of a cloud.

use super::Calibration;
use crate::{
    dense::{Dense, FILLED},
    disparity::{DisparityMap, NONE, pixels},
    error::{Result, check},
};

/// Error of a disparity that is allowed for, in pixels: that of a disparity without interpolation.
const DISPARITY_ERROR: f64 = 0.5;
/// Largest error of a known depth, as a share of the depth.
const DEPTH_ERROR: f64 = 0.1;

/// Which pixels of a map become points of a cloud: those that are near enough for their depth to be known, and sure enough.
///
/// A disparity that is off by `e` pixels puts a point at depth `Z` off by `Z^2 e / (f B)`, for a focal length of `f` pixels and a
/// baseline of `B` metres (Gallup, Frahm, Mordohai and Pollefeys, 'Variable Baseline/Resolution Stereo', CVPR 2008):
/// a disparity near 0 puts it kilometres away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointFilter {
    /// Largest depth in the rectified reference camera, in metres, above 0; infinity for any.
    pub max_depth: f64,
    /// Least confidence ([`Dense::confidence`]), 0 to 255.
    pub min_confidence: u8,
}

/// Numbers of pixels that have a disparity and are no points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Pixels of less confidence than the least.
    pub unsure: usize,
    /// Pixels of enough confidence that are further away than the largest depth, or at infinity.
    pub beyond: usize,
}

impl PointFilter {
    /// Measured pixels up to the depth at which half a pixel of disparity is a tenth of the depth: `0.2 f B`, where disparity and
    /// `doffs` together are 5 px. Neither filled pixels nor doubtful ones, of confidence 0.
    pub fn new(calibration: &Calibration) -> Self {
        let max_depth = DEPTH_ERROR / DISPARITY_ERROR * calibration.focal * calibration.baseline;
        Self { max_depth, min_confidence: FILLED + 1 }
    }

    /// Checks the largest depth.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for one that is not above 0.
    pub fn validate(&self) -> Result<()> {
        check(
            self.max_depth > 0.0,
            "the largest depth",
            self.max_depth,
            "it must be above 0 metres, or inf for any depth",
        )
    }

    /// The map without the pixels that are no points.
    pub fn apply(&self, dense: &Dense, calibration: &Calibration) -> (DisparityMap, LeftOut) {
        let mut left_out = LeftOut::default();
        let map = DisparityMap::from_fn(dense.disparity.size(), |x, y| {
            let disparity = dense.disparity.get(x, y);
            let Some(in_pixels) = pixels(disparity) else { return NONE };
            if dense.confidence.get(x, y) < self.min_confidence {
                left_out.unsure += 1;
                return NONE;
            }
            let is_near = calibration.depth(in_pixels.into()).is_some_and(|depth| depth <= self.max_depth);
            left_out.beyond += usize::from(!is_near);
            if is_near { disparity } else { NONE }
        });
        (map, left_out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;

    fn calibration() -> Calibration {
        Calibration::centred(100.0, 0.5, 2.0, (6, 1)).unwrap()
    }

    #[test]
    fn a_tenth_of_the_depth_is_half_a_pixel_at_the_largest_depth() {
        let filter = PointFilter::new(&calibration());
        assert_eq!(filter, PointFilter { max_depth: 10.0, min_confidence: 16 });
        let [nearer, at, farther] = [3.5, 3.0, 2.5].map(|disparity| calibration().depth(disparity).unwrap());
        assert_eq!(at, 10.0);
        // To first order, the mean of both sides.
        assert!(((farther - nearer) / 2.0 / at - 0.1).abs() < 0.002, "{nearer} {farther}");
    }

    #[test]
    fn points_by_hand() {
        // 10 m, just beyond, at infinity, none, filled, near.
        let disparity =
            DisparityMap::new((6, 1), vec![3 * 256, 3 * 256 - 1, -2 * 256, NONE, 40 * 256, 50 * 256]).unwrap();
        let confidence = Plane::new((6, 1), vec![16, 200, 200, 0, 15, 90]).unwrap();
        let dense = Dense { disparity, confidence };
        let apply = |filter: PointFilter| {
            let (map, left_out) = filter.apply(&dense, &calibration());
            (map.data().iter().map(|&d| d != NONE).collect::<Vec<_>>(), left_out)
        };
        let filter = PointFilter::new(&calibration());
        let [yes, no] = [true, false];
        assert_eq!(apply(filter), (vec![yes, no, no, no, no, yes], LeftOut { unsure: 1, beyond: 2 }));
        let filled = PointFilter { min_confidence: 1, ..filter };
        assert_eq!(apply(filled), (vec![yes, no, no, no, yes, yes], LeftOut { unsure: 0, beyond: 2 }));
        let any_depth = PointFilter { max_depth: f64::INFINITY, ..filter };
        assert_eq!(apply(any_depth), (vec![yes, yes, no, no, no, yes], LeftOut { unsure: 1, beyond: 1 }));
        let sure = PointFilter { min_confidence: 91, ..filter };
        assert_eq!(apply(sure), (vec![no; 6], LeftOut { unsure: 3, beyond: 2 }));
    }

    #[test]
    fn a_largest_depth_is_above_0() {
        for max_depth in [0.0, -1.0, f64::NAN] {
            let error = PointFilter { max_depth, min_confidence: 0 }.validate().unwrap_err().to_string();
            assert!(error.contains("it must be above 0 metres"), "{error}");
        }
    }
}
