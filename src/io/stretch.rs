//! The linear stretch of deep samples to 8 bits.
//!
//! Sensors of 12 to 16 bits mostly use a small part of their span: a thermal picture of 1,660 steps around 30,000 has 8
//! values left in its upper 8 bits. What is in use is therefore stretched over 8 bits, both views of a pair alike, so
//! that equal samples stay equal.
//!
//! Two rules find what is in use:
//! - 0.5 % of the samples at either end are left out: hot and dead pixels. Shares from 0 to 5 % give 13.0 to 13.5 % of
//!   pixels wrong by over 2 px on a thermal pair (1,660 steps, a part of Cones; `balanced`, 75 disparities), the upper
//!   8 bits 24.2 %.
//! - The value at an end is left out if the others, without it, span less than half, and have more different values
//!   than grey values with it: a value for missing data, such as -9999, at any share of pixels.

use super::samples::{Kind, Samples};

/// Samples at either end that are left out: one of so many, 0.5 %.
const OUTLIERS: usize = 200;

/// Pixels per view that are looked at; a larger view is sampled.
const ENOUGH: usize = 1 << 18;

/// Span below which 16-bit samples are stretched. The upper 8 bits of a larger span have at least 128 grey values.
///
/// Pixels wrong by over 2 px with 256, 128 and 64 grey values (`balanced`, 75 disparities): Cones 6.4, 6.9 and 7.5 %,
/// Motorcycle 8.1, 8.6 and 10.3 %.
const WIDE: f64 = 32_768.0;

/// A linear map of samples to 8 bits, rounded: `low` becomes 0, `high` 255, and what lies outside is clamped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The sample that becomes 0, in the file's unit.
    pub low: f32,
    /// The sample that becomes 255, in the file's unit.
    pub high: f32,
}

impl Stretch {
    /// The grey value of a sample, 0 to 255; 0 for NaN, and for all if `low` is `high`.
    pub fn grey(self, sample: f32) -> u8 {
        let [low, high, sample] = [self.low, self.high, sample].map(f64::from);
        let grey = (sample - low) * 255.0 / (high - low);
        // The conversion clamps, and NaN becomes 0.
        if low < high { (grey + 0.5) as u8 } else { 0 }
    }

    /// The common stretch of the views of one pair; `None` if the upper 8 bits of 16-bit samples serve as well.
    ///
    /// Floats are always stretched. 16-bit samples are not if they use half of the 16 bits or more, or hold 8-bit
    /// values, `257 v` or `256 v`. Views of 8 bits are left out.
    pub(super) fn of(views: &[&Samples]) -> Option<Self> {
        let deep: Vec<&Samples> = views.iter().copied().filter(|view| view.kind() != Kind::Eight).collect();
        let is_float = deep.iter().any(|view| view.kind() == Kind::Float);
        if deep.is_empty() || !is_float && hold_8_bits(&deep) {
            return None;
        }
        let mut samples: Vec<f32> = deep.iter().flat_map(|view| some_samples(view)).collect();
        samples.sort_unstable_by(f32::total_cmp);
        let stretch = in_use(&samples)?;
        let is_narrow = stretch.span() > 0.0 && stretch.span() < WIDE;
        (is_float || is_narrow).then_some(stretch)
    }

    fn span(self) -> f64 {
        f64::from(self.high) - f64::from(self.low)
    }
}

/// Whether all seen samples are multiples of 257, or all of 256: 8-bit values in 16 bits.
fn hold_8_bits(views: &[&Samples]) -> bool {
    let (mut by_257, mut by_256) = (true, true);
    for view in views {
        view.for_each_seen(|color| {
            for sample in color.map(|sample| sample as u16) {
                by_257 &= sample % 257 == 0;
                by_256 &= sample % 256 == 0;
            }
        });
    }
    by_257 || by_256
}

/// Samples of seen pixels at equal distances, an odd number of pixels that runs through all columns of most widths.
fn some_samples(view: &Samples) -> Vec<f32> {
    let step = (view.count_seen() / ENOUGH) | 1;
    let (mut samples, mut index) = (Vec::new(), 0);
    view.for_each_seen(|color| {
        if index % step == 0 {
            samples.extend(color);
        }
        index += 1;
    });
    samples
}

/// The span of `sorted` samples without outliers and without a far value at either end; `None` of no samples.
fn in_use(mut sorted: &[f32]) -> Option<Stretch> {
    loop {
        let all = without_outliers(sorted)?;
        let start = sorted.partition_point(|&sample| sample <= all.low);
        let end = sorted.partition_point(|&sample| sample < all.high);
        let others = [&sorted[start..], &sorted[..end], sorted.get(start..end).unwrap_or_default()];
        match others.into_iter().find(|others| is_starved(others, all)) {
            Some(others) => sorted = others,
            None => return Some(all),
        }
    }
}

fn without_outliers(sorted: &[f32]) -> Option<Stretch> {
    let left_out = sorted.len() / OUTLIERS;
    Some(Stretch { low: *sorted.get(left_out)?, high: *sorted.get(sorted.len() - 1 - left_out)? })
}

/// Whether a stretch of `all` would leave `others`, a part of all samples, less than half of the grey values, and fewer
/// than there are different samples.
fn is_starved(others: &[f32], all: Stretch) -> bool {
    let Some(span) = without_outliers(others).map(Stretch::span) else { return false };
    let distinct = 1 + others.windows(2).filter(|pair| pair[0] < pair[1]).count();
    span > 0.0 && 2.0 * span < all.span() && 256.0 * span < distinct as f64 * all.span()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(mut samples: Vec<f32>) -> Option<(f32, f32)> {
        samples.sort_unstable_by(f32::total_cmp);
        in_use(&samples).map(|Stretch { low, high }| (low, high))
    }

    #[test]
    fn grey_values_by_hand() {
        let stretch = Stretch { low: 1000.0, high: 1510.0 };
        // 2 samples per grey value; 1003 is 1.5, up.
        assert_eq!([1000.0, 1002.0, 1003.0, 1510.0].map(|sample| stretch.grey(sample)), [0, 1, 2, 255]);
        assert_eq!([-9999.0, 65535.0, f32::NAN, f32::INFINITY].map(|sample| stretch.grey(sample)), [0, 255, 0, 255]);
        assert_eq!([0.0, 7.0, 9.0].map(|sample| Stretch { low: 7.0, high: 7.0 }.grey(sample)), [0; 3]);
        let extreme = Stretch { low: f32::MIN, high: f32::MAX };
        assert_eq!([f32::MIN, 0.0, f32::MAX].map(|sample| extreme.grey(sample)), [0, 128, 255]);
    }

    #[test]
    fn quantiles_by_hand() {
        // 1 to 199: nothing is left out; 1 to 400: two at either end.
        assert_eq!(ends((1..=199).map(|value| value as f32).collect()), Some((1.0, 199.0)));
        assert_eq!(ends((1..=400).map(|value| value as f32).collect()), Some((3.0, 398.0)));
        assert_eq!(ends(vec![]), None);
        assert_eq!(ends(vec![4.0]), Some((4.0, 4.0)));
    }

    #[test]
    fn outliers_do_not_move_the_span() {
        let scene = || (1..=396).map(|value| 30_000.0 + value as f32);
        // Two dead and two hot pixels of 400 are 0.5 % each.
        let few = scene().chain([0.0, 5.0, 65_000.0, 65_535.0]).collect();
        assert_eq!(ends(few), Some((30_001.0, 30_396.0)));
        // One value of a third of the pixels, at either end or both.
        let low = scene().chain([-9999.0; 200]).collect();
        assert_eq!(ends(low), Some((30_002.0, 30_395.0)));
        let both = scene().chain([0.0; 200]).chain([65_535.0; 200]).collect();
        assert_eq!(ends(both), Some((30_002.0, 30_395.0)));
        let around = scene().chain([29_000.0; 200]).chain([31_400.0; 200]).collect();
        assert_eq!(ends(around), Some((30_002.0, 30_395.0)));
        let largest = scene().chain([f32::MIN; 200]).collect();
        assert_eq!(ends(largest), Some((30_002.0, 30_395.0)));
    }

    #[test]
    fn values_that_cost_no_grey_values_stay() {
        // The others span 393 of 693 with 0.
        let near = (300..=695).map(|value| value as f32).chain([0.0; 200]).collect();
        assert_eq!(ends(near), Some((0.0, 693.0)));
        assert_eq!(ends([[0.0; 50], [1000.0; 50]].concat()), Some((0.0, 1000.0)));
        // 20 and 30 keep two different grey values beside 1000: 256 * 10 / 980 is 2.6.
        assert_eq!(ends([[20.0; 50], [30.0; 50], [1000.0; 50]].concat()), Some((20.0, 1000.0)));
    }
}
