//! Measures of the Middlebury benchmark (Scharstein and Szeliski, IJCV 47, 2002, section 5.1; Scharstein et al., GCPR
//! 2014, section 5) and of the KITTI benchmark (Menze and Geiger, CVPR 2015, section 5). Missing estimates are kept
//! apart from wrong ones.

use crate::{
    disparity::{self, DisparityMap},
    error::{Error, Result},
    image::{Plane, Size},
};

/// Mask value of scored pixels.
const SCORED: u8 = 255;

/// Shares of pixels with an error above a threshold, Middlebury's 'bad'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bad {
    /// Largest error that counts as right, in pixels.
    pub threshold: f32,
    /// Share of the scored pixels with a larger error or without an estimate, 0 to 1.
    pub of_known: f64,
    /// Share of the estimated pixels with a larger error, 0 to 1.
    pub of_estimated: f64,
}

/// Shares of KITTI's outliers, 'D1': pixels with an error above [`OUTLIER_PIXELS`] and above [`OUTLIER_SHARE`] of the
/// true disparity.
///
/// KITTI's own tool fills a map's holes before it counts over all pixels; here a hole is an outlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outliers {
    /// Share of the scored pixels that are outliers or have no estimate, 0 to 1.
    pub of_known: f64,
    /// Share of the estimated pixels that are outliers, 0 to 1.
    pub of_estimated: f64,
}

/// Largest error of a pixel that is no outlier, in pixels.
pub const OUTLIER_PIXELS: f64 = 3.0;

/// Largest error of a pixel that is no outlier, as a share of the true disparity.
pub const OUTLIER_SHARE: f64 = 0.05;

/// Score of a disparity map against the ground truth.
///
/// A pixel is *scored* if its ground truth is known and the mask, if any, is 255 there; it is *estimated* if it is
/// scored and the map has a disparity. Without scored or estimated pixels the shares and averages are undefined: they
/// are NaN, never a flattering 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// Number of scored pixels.
    pub known: usize,
    /// Number of estimated pixels.
    pub estimated: usize,
    /// Shares of wrong pixels, in the order of the requested thresholds.
    pub bad: Vec<Bad>,
    /// Mean absolute error of the estimated pixels, in pixels.
    pub average: f64,
    /// Root of the mean squared error of the estimated pixels, in pixels.
    pub rms: f64,
    /// Smallest error that half of the estimated pixels do not exceed, in pixels.
    pub a50: f64,
    /// Smallest error that 90 % of the estimated pixels do not exceed, in pixels.
    pub a90: f64,
    /// Smallest error that 99 % of the estimated pixels do not exceed, in pixels.
    pub a99: f64,
    /// Shares of KITTI's outliers.
    pub d1: Outliers,
}

impl Score {
    /// Coverage, the share of the scored pixels that have an estimate, 0 to 1; both benchmarks call it density.
    pub fn coverage(&self) -> f64 {
        self.estimated as f64 / self.known as f64
    }
}

/// Scores `map`, in 1/256 px, against `truth`, in pixels and not finite where unknown, where `mask` is 255.
/// `thresholds` are those of [`Score::bad`], in pixels.
///
/// An error of exactly the threshold is right. `truth` is not rounded to 1/256 px.
///
/// # Errors
/// [`Error::Parameter`] if the sizes differ or a threshold is negative or NaN.
pub fn score(map: &DisparityMap, truth: &Plane<f32>, mask: Option<&Plane<u8>>, thresholds: &[f32]) -> Result<Score> {
    score_pixels(&disparity::in_pixels(map), truth, mask, thresholds)
}

/// As [`score`], for a map in pixels, not finite where there is no estimate.
///
/// # Errors
/// As [`score`].
pub fn score_pixels(
    map: &Plane<f32>,
    truth: &Plane<f32>,
    mask: Option<&Plane<u8>>,
    thresholds: &[f32],
) -> Result<Score> {
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
    let (mut known, mut outliers, mut errors) = (0, 0, Vec::new());
    for i in (0..map.data().len()).filter(|&i| scored(i)) {
        known += 1;
        if map.data()[i].is_finite() {
            let truth = f64::from(truth.data()[i]);
            let error = (f64::from(map.data()[i]) - truth).abs();
            outliers += usize::from(error > OUTLIER_PIXELS && error > OUTLIER_SHARE * truth.abs());
            errors.push(error);
        }
    }
    errors.sort_unstable_by(f64::total_cmp);

    let estimated = errors.len();
    let missing = known - estimated;
    let shares = |wrong: usize| ((wrong + missing) as f64 / known as f64, wrong as f64 / estimated as f64);
    let bad = thresholds.iter().map(|&threshold| {
        let right = errors.partition_point(|&error| error <= f64::from(threshold));
        let (of_known, of_estimated) = shares(estimated - right);
        Bad { threshold, of_known, of_estimated }
    });
    let (of_known, of_estimated) = shares(outliers);
    Ok(Score {
        known,
        estimated,
        bad: bad.collect(),
        average: errors.iter().sum::<f64>() / estimated as f64,
        rms: (errors.iter().map(|error| error * error).sum::<f64>() / estimated as f64).sqrt(),
        a50: quantile(&errors, 50),
        a90: quantile(&errors, 90),
        a99: quantile(&errors, 99),
        d1: Outliers { of_known, of_estimated },
    })
}

/// Smallest of the sorted values that `percent` per cent of them do not exceed; NaN without values.
fn quantile(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len() * percent).div_ceil(100);
    rank.checked_sub(1).map_or(f64::NAN, |index| sorted[index])
}

fn same_size(name: &'static str, size: Size, map_size: Size) -> Result<()> {
    if size == map_size {
        return Ok(());
    }
    Err(Error::Parameter {
        name,
        value: format!("{}x{} pixels", size.width, size.height),
        expected: format!("the disparity map has {}x{}", map_size.width, map_size.height),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disparity::NONE;

    fn truth() -> Plane<f32> {
        Plane::new((3, 2), vec![1.0, 2.0, f32::INFINITY, 4.0, 0.0, -3.5]).unwrap()
    }

    fn map(values: [i32; 6]) -> DisparityMap {
        Plane::new((3, 2), values.to_vec()).unwrap()
    }

    #[test]
    fn perfect_map_has_no_error() {
        let score = score(&map([256, 512, NONE, 1024, 0, -896]), &truth(), None, &[0.0, 1.0]).unwrap();
        assert_eq!((score.known, score.estimated, score.coverage()), (5, 5, 1.0));
        assert_eq!((score.average, score.rms), (0.0, 0.0));
        assert_eq!((score.a50, score.a90, score.a99), (0.0, 0.0, 0.0));
        assert_eq!(score.d1, Outliers { of_known: 0.0, of_estimated: 0.0 });
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
        assert!(score.a50.is_nan() && score.a90.is_nan() && score.a99.is_nan());
        assert!(score.d1.of_known == 1.0 && score.d1.of_estimated.is_nan());
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
        // Half of four errors are two; 90 and 99 % of four are all four.
        assert_eq!((all.a50, all.a90, all.a99), (1.0, 4.0, 4.0));
        // The error of 3 px is not above 3 px; the error of 4 px is, and it is above 5 % of 3.5 px.
        assert_eq!(all.d1, Outliers { of_known: 2.0 / 5.0, of_estimated: 1.0 / 4.0 });

        // 128 is not 255: only pixels 0, 3 and 4 are scored.
        let mask = Plane::new((3, 2), vec![255, 128, 255, 255, 255, 0]).unwrap();
        let masked = score(&map, &truth(), Some(&mask), &[1.0]).unwrap();
        assert_eq!((masked.known, masked.estimated), (3, 2));
        assert_eq!(masked.bad[0], Bad { threshold: 1.0, of_known: 2.0 / 3.0, of_estimated: 0.5 });
        assert_eq!((masked.average, masked.a50, masked.a99), (1.5, 0.0, 3.0));
        assert_eq!(masked.d1, Outliers { of_known: 1.0 / 3.0, of_estimated: 0.0 });
    }

    #[test]
    fn quantiles_by_hand() {
        // Errors 1 to 200: half of them are at most 100, 90 % at most 180, 99 % at most 198.
        let map = Plane::from_fn((200, 1), |x, _| (x * 77 % 200 + 1) as f32);
        let score = score_pixels(&map, &Plane::filled((200, 1), 0.0), None, &[]).unwrap();
        assert_eq!((score.a50, score.a90, score.a99), (100.0, 180.0, 198.0));
        // Half of three values are at most the second one.
        assert_eq!([1, 50, 67, 100].map(|percent| quantile(&[1.0, 2.0, 5.0], percent)), [1.0, 2.0, 5.0, 5.0]);
    }

    /// Random maps, counted pixel by pixel; quantiles by trying every error.
    #[test]
    fn figures_agree_with_brute_force() {
        let mut state = 7_u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for round in 0..50 {
            let (width, height) = (1 + random(20), 1 + random(20));
            let mut sparse = |scale: f32| {
                Plane::from_fn((width, height), |_, _| {
                    if random(5) == 0 { f32::INFINITY } else { random(4000) as f32 / scale - 9.0 }
                })
            };
            let (map, truth) = (sparse(256.0), sparse(250.0));
            let mask = Plane::from_fn((width, height), |_, _| [0, 128, 255, 255][random(4) as usize]);
            let found = score_pixels(&map, &truth, Some(&mask), &[0.5, 4.0]).unwrap();

            let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let known = || pixels().filter(|&(x, y)| truth.get(x, y) < f32::INFINITY && mask.get(x, y) == 255);
            let estimated = || known().filter(|&(x, y)| map.get(x, y) < f32::INFINITY);
            let error = |(x, y): (u32, u32)| (f64::from(map.get(x, y)) - f64::from(truth.get(x, y))).abs();
            let share = |wrong: usize, of: usize| wrong as f64 / of as f64;
            let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 || a.is_nan() && b.is_nan(), "{round}: {a}, {b}");

            let (all, some) = (known().count(), estimated().count());
            assert_eq!((found.known, found.estimated), (all, some));
            for bad in &found.bad {
                let right = estimated().filter(|&at| error(at) <= f64::from(bad.threshold)).count();
                same(bad.of_known, share(all - right, all));
                same(bad.of_estimated, share(some - right, some));
            }
            let outlier =
                |&(x, y): &(u32, u32)| error((x, y)) > 3.0 && error((x, y)) > 0.05 * f64::from(truth.get(x, y).abs());
            let outliers = estimated().filter(outlier).count();
            same(found.d1.of_estimated, share(outliers, some));
            same(found.d1.of_known, share(outliers + all - some, all));
            same(found.average, estimated().map(error).sum::<f64>() / some as f64);
            same(found.rms, (estimated().map(|at| error(at).powi(2)).sum::<f64>() / some as f64).sqrt());
            for (quantile, percent) in [(found.a50, 50), (found.a90, 90), (found.a99, 99)] {
                let enough = |&e: &f64| 100 * estimated().filter(|&at| error(at) <= e).count() >= percent * some;
                same(quantile, estimated().map(error).filter(enough).reduce(f64::min).unwrap_or(f64::NAN));
            }
        }
    }

    /// 5 % of 100 px are 5 px; 5 % of 40 px are 2 px, and the limit of 3 px decides.
    #[test]
    fn outliers_by_hand() {
        let truth = Plane::new((7, 1), vec![100.0, 100.0, 40.0, 40.0, -100.0, 0.0, f32::INFINITY]).unwrap();
        let map = Plane::new((7, 1), vec![104.9, 105.1, 42.9, 43.1, -105.1, f32::INFINITY, 9.0]).unwrap();
        let score = score_pixels(&map, &truth, None, &[]).unwrap();
        assert_eq!(score.d1, Outliers { of_known: 4.0 / 6.0, of_estimated: 3.0 / 5.0 });
    }

    #[test]
    fn a_map_in_pixels_is_not_rounded() {
        let map = Plane::new((3, 2), vec![1.001, 2.0, f32::NAN, f32::INFINITY, 0.0, -3.5]).unwrap();
        let score = score_pixels(&map, &truth(), None, &[0.0005]).unwrap();
        assert_eq!((score.known, score.estimated), (5, 4));
        assert_eq!(score.bad[0].of_estimated, 0.25);
        assert_eq!(score.average, (f64::from(1.001f32) - 1.0) / 4.0);
    }

    #[test]
    fn nothing_known_gives_no_figures() {
        let unknown = Plane::filled((3, 2), f32::NAN);
        let score = score(&map([0; 6]), &unknown, None, &[1.0]).unwrap();
        assert_eq!(score.known, 0);
        assert!(score.bad[0].of_known.is_nan() && score.coverage().is_nan());
    }

    #[test]
    fn sizes_and_thresholds_are_checked() {
        let map = map([0; 6]);
        let message = |result: Result<Score>| result.unwrap_err().to_string();
        assert!(message(score(&map, &Plane::filled((2, 3), 0.0), None, &[])).contains("the truth is 2x3"));
        assert!(message(score(&map, &truth(), Some(&Plane::filled((1, 1), 0)), &[])).contains("the mask is 1x1"));
        assert!(message(score(&map, &truth(), None, &[f32::NAN])).contains("threshold"));
    }
}
