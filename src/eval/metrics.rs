//! The measures of the Middlebury benchmark (Scharstein and Szeliski, IJCV 47, 2002, section 5.1), with missing values
//! told apart from wrong ones.

use crate::{
    disparity::{self, DisparityMap},
    error::{Error, Result},
    image::Plane,
};

/// The value of a mask's pixels that are scored.
const SCORED: u8 = 255;

/// The share of pixels that are wrong by more than a threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bad {
    /// The largest error in pixels that still counts as right.
    pub threshold: f32,
    /// The share of the scored pixels that are further off or have no estimate, 0 to 1.
    pub of_known: f64,
    /// The share of the estimated pixels that are further off, 0 to 1.
    pub of_estimated: f64,
}

/// How a disparity map compares with the truth.
///
/// A pixel is *scored* if its truth is known and the mask, where there is one, is 255 there; it is *estimated* if it
/// is scored and the map has a disparity. Where nothing is scored or estimated there is no share and no average:
/// these figures are NaN then, never a flattering 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Scored pixels.
    pub known: usize,
    /// Estimated pixels.
    pub estimated: usize,
    /// Wrong pixels, in the order of the thresholds that were asked for.
    pub bad: Vec<Bad>,
    /// Mean absolute error of the estimated pixels, in pixels.
    pub average: f64,
    /// Root of the mean squared error of the estimated pixels, in pixels.
    pub rms: f64,
}

impl Score {
    /// The share of the scored pixels that have an estimate, 0 to 1.
    pub fn coverage(&self) -> f64 {
        self.estimated as f64 / self.known as f64
    }
}

/// Compares `map` with `truth`, in which a value that is not finite means 'unknown'.
///
/// An error of exactly the threshold is right. Errors are taken between the map's 1/256 px and the truth as it is.
///
/// # Errors
/// [`Error::Parameter`] if the sizes differ or a threshold is negative or not a number.
pub fn score(map: &DisparityMap, truth: &Plane<f32>, mask: Option<&Plane<u8>>, thresholds: &[f32]) -> Result<Score> {
    same_size("the truth", truth.size(), map.size())?;
    if let Some(mask) = mask {
        same_size("the mask", mask.size(), map.size())?;
    }
    if let Some(threshold) = thresholds.iter().find(|&&threshold| threshold.is_nan() || threshold < 0.0) {
        return Err(Error::Parameter {
            name: "threshold",
            value: threshold.to_string(),
            expected: "it must be a number of pixels from 0 up".into(),
        });
    }

    let scored = |i: usize| truth.data()[i].is_finite() && mask.is_none_or(|mask| mask.data()[i] == SCORED);
    let known = (0..map.data().len()).filter(|&i| scored(i)).count();
    let errors: Vec<f64> = (0..map.data().len())
        .filter(|&i| scored(i))
        .filter_map(|i| Some((f64::from(disparity::pixels(map.data()[i])?) - f64::from(truth.data()[i])).abs()))
        .collect();

    let estimated = errors.len();
    let missing = known - estimated;
    let bad = thresholds
        .iter()
        .map(|&threshold| {
            let wrong = errors.iter().filter(|&&error| error > f64::from(threshold)).count();
            Bad {
                threshold,
                of_known: (wrong + missing) as f64 / known as f64,
                of_estimated: wrong as f64 / estimated as f64,
            }
        })
        .collect();
    Ok(Score {
        known,
        estimated,
        bad,
        average: errors.iter().sum::<f64>() / estimated as f64,
        rms: (errors.iter().map(|error| error * error).sum::<f64>() / estimated as f64).sqrt(),
    })
}

fn same_size(name: &'static str, size: (u32, u32), wanted: (u32, u32)) -> Result<()> {
    if size == wanted {
        return Ok(());
    }
    Err(Error::Parameter {
        name,
        value: format!("{}x{} pixels", size.0, size.1),
        expected: format!("the disparity map has {}x{}", wanted.0, wanted.1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::NONE;

    fn truth() -> Plane<f32> {
        Plane::new(3, 2, vec![1.0, 2.0, f32::INFINITY, 4.0, 0.0, -3.5]).unwrap()
    }

    fn map(values: [i32; 6]) -> DisparityMap {
        Plane::new(3, 2, values.to_vec()).unwrap()
    }

    #[test]
    fn perfect_map_has_no_error() {
        let score = score(&map([256, 512, NONE, 1024, 0, -896]), &truth(), None, &[0.0, 1.0]).unwrap();
        assert_eq!((score.known, score.estimated, score.coverage()), (5, 5, 1.0));
        assert_eq!((score.average, score.rms), (0.0, 0.0));
        for bad in score.bad {
            assert_eq!((bad.of_known, bad.of_estimated), (0.0, 0.0));
        }
    }

    #[test]
    fn one_changed_pixel_is_seen() {
        let score = score(&map([256, 512, NONE, 1024, 0, -895]), &truth(), None, &[0.0]).unwrap();
        assert_eq!(score.bad[0].of_known, 0.2);
        assert_eq!(score.average, 1.0 / 256.0 / 5.0);
    }

    #[test]
    fn empty_map_is_all_wrong_and_has_no_average() {
        let score = score(&map([NONE; 6]), &truth(), None, &[1.0]).unwrap();
        assert_eq!((score.estimated, score.coverage(), score.bad[0].of_known), (0, 0.0, 1.0));
        assert!(score.average.is_nan() && score.rms.is_nan() && score.bad[0].of_estimated.is_nan());
    }

    /// Errors by pixel: 0, 1 (right at threshold 1), unknown, 3, missing, 4.
    #[test]
    fn figures_agree_with_a_calculation_by_hand() {
        let map = map([256, 768, 99, 256, NONE, 128]);
        let all = score(&map, &truth(), None, &[1.0, 0.5, 3.0]).unwrap();
        assert_eq!((all.known, all.estimated), (5, 4));
        assert_eq!(all.bad[0], Bad { threshold: 1.0, of_known: 3.0 / 5.0, of_estimated: 2.0 / 4.0 });
        assert_eq!(all.bad[1], Bad { threshold: 0.5, of_known: 4.0 / 5.0, of_estimated: 3.0 / 4.0 });
        assert_eq!(all.bad[2], Bad { threshold: 3.0, of_known: 2.0 / 5.0, of_estimated: 1.0 / 4.0 });
        assert_eq!(all.average, 2.0);
        assert_eq!(all.rms, (26.0f64 / 4.0).sqrt());

        // 128 is not 255: only pixels 0, 3 and 4 are scored.
        let mask = Plane::new(3, 2, vec![255, 128, 255, 255, 255, 0]).unwrap();
        let masked = score(&map, &truth(), Some(&mask), &[1.0]).unwrap();
        assert_eq!((masked.known, masked.estimated), (3, 2));
        assert_eq!(masked.bad[0], Bad { threshold: 1.0, of_known: 2.0 / 3.0, of_estimated: 0.5 });
        assert_eq!(masked.average, 1.5);
    }

    #[test]
    fn nothing_known_gives_no_figures() {
        let unknown = Plane::filled(3, 2, f32::NAN);
        let score = score(&map([0; 6]), &unknown, None, &[1.0]).unwrap();
        assert_eq!(score.known, 0);
        assert!(score.bad[0].of_known.is_nan() && score.coverage().is_nan());
    }

    #[test]
    fn sizes_and_thresholds_are_checked() {
        let map = map([0; 6]);
        let message = |result: Result<Score>| result.unwrap_err().to_string();
        assert!(message(score(&map, &Plane::filled(2, 3, 0.0), None, &[])).contains("the truth is 2x3"));
        assert!(message(score(&map, &truth(), Some(&Plane::filled(1, 1, 0)), &[])).contains("the mask is 1x1"));
        assert!(message(score(&map, &truth(), None, &[f32::NAN])).contains("threshold"));
    }
}
