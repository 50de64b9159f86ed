//! Gain and offset between the grey values of the two views.

use crate::{dense::Brightness, image::Luma, matching::Seed, rectify::RowModel};

/// Half the side of the 7x7 window over which grey values are averaged, in pixels.
const HALF: i64 = 3;
/// Largest number of seeds used, the most confident ones: the slopes of all their pairs are computed.
const MOST: usize = 500;
/// Smallest number of seeds needed.
const NEEDED: usize = 12;
/// Smallest difference of two windows, in grey values, for their slope to be meaningful.
const CONTRAST: f32 = 10.0;

/// Linear relation between the grey values of the two views: right = gain * left + offset.
///
/// The relation is measured; [`crate::dense::Brightness`] is the change that equalises the views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrightnessRelation {
    /// Contrast of the right view divided by that of the left view.
    pub gain: f32,
    /// Grey value of the right view where the left view is black, in grey values of 0 to 255.
    pub offset: f32,
    /// Robust standard deviation of corresponding windows from the line, in grey values.
    pub residual: f32,
}

impl BrightnessRelation {
    /// Fits the line to the mean grey values of corresponding windows of a left view and a right view resampled by `rows`;
    /// `None` for fewer than 12 usable seeds, or without contrast between their windows.
    ///
    /// The slope is the median of the slopes of all pairs (Theil 1950, Sen 1968), which up to 29 % of wrong seeds
    /// cannot move far. Windows with a black or a white pixel are left out, since the sensor may have clipped them.
    pub(super) fn new(left: &Luma, right: &Luma, seeds: &[Seed], rows: &RowModel) -> Option<Self> {
        let row_of = |seed: &Seed| rows.left_row(seed.right_x().into(), seed.right_y().into()) as f32;
        let means: Vec<(f32, f32)> = seeds
            .iter()
            .filter_map(|seed| Some((mean(left, seed.x, seed.y)?, mean(right, seed.right_x(), row_of(seed))?)))
            .take(MOST)
            .collect();
        if means.len() < NEEDED {
            return None;
        }
        let pairs = means.iter().enumerate().flat_map(|(i, &a)| means[..i].iter().map(move |&b| (a, b)));
        let slopes = pairs.filter(|(a, b)| (a.0 - b.0).abs() >= CONTRAST).map(|(a, b)| (a.1 - b.1) / (a.0 - b.0));
        let gain = median(slopes.collect())?;
        let offset = median(means.iter().map(|(l, r)| r - gain * l).collect())?;
        let spread = median(means.iter().map(|(l, r)| (r - gain * l - offset).abs()).collect())?;
        Some(Self { gain, offset, residual: super::DEVIATIONS * spread })
    }

    /// The change that gives the right view the brightness of the left one; [`Brightness::SAME`] for a relation outside
    /// gains of 0.1 to 10 and offsets of 255 grey levels.
    pub fn equalising(&self) -> Brightness {
        if !(0.1..=10.0).contains(&self.gain) || self.offset.abs() > 255.0 {
            return Brightness::SAME;
        }
        let fixed_point = |value: f32| (256.0 * value).round() as i32;
        Brightness { gain: fixed_point(1.0 / self.gain), offset: fixed_point(-self.offset / self.gain) }
    }
}

fn mean(view: &Luma, x: f32, y: f32) -> Option<f32> {
    let (x, y) = (x.round() as i64, y.round() as i64);
    let values = (-HALF..=HALF).flat_map(|j| (-HALF..=HALF).map(move |i| view.get_clamped(x + i, y + j)));
    let (mut sum, mut count) = (0, 0);
    for value in values {
        if value == u8::MIN || value == u8::MAX {
            return None;
        }
        sum += u32::from(value);
        count += 1;
    }
    Some(sum as f32 / count as f32)
}

/// Median, the upper middle value of an even number; `None` without values.
pub(super) fn median(mut values: Vec<f32>) -> Option<f32> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_gain_and_offset_despite_a_quarter_of_wrong_seeds() {
        let left = Luma::from_fn((100, 100), |x, y| (40 + x + y / 2) as u8);
        let right = Luma::from_fn((100, 100), |x, y| (0.5 * (40.0 + (x + 4) as f32 + (y / 2) as f32) + 20.0) as u8);
        let seeds: Vec<Seed> = (0..80)
            .map(|i| {
                let disparity = if i % 4 == 0 { 40.0 } else { 4.0 };
                Seed { x: 45.0 + (i % 10) as f32 * 5.0, y: 5.0 + i as f32, disparity, dy: 0.0, confidence: 1.0 }
            })
            .collect();
        let found = BrightnessRelation::new(&left, &right, &seeds, &RowModel::AS_IS).unwrap();
        assert!((found.gain - 0.5).abs() < 0.03 && (found.offset - 20.0).abs() < 3.0, "{found:?}");
    }

    #[test]
    fn nothing_is_claimed_without_contrast_or_seeds() {
        let grey = Luma::filled((50, 50), 90);
        let seeds = [Seed { x: 20.0, y: 20.0, disparity: 1.0, dy: 0.0, confidence: 1.0 }; 20];
        assert_eq!(BrightnessRelation::new(&grey, &grey, &seeds, &RowModel::AS_IS), None);
        assert_eq!(BrightnessRelation::new(&grey, &grey, &[], &RowModel::AS_IS), None);
        let white = Luma::filled((50, 50), 255);
        assert_eq!(BrightnessRelation::new(&white, &grey, &seeds, &RowModel::AS_IS), None);
    }

    #[test]
    fn median_by_hand() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(3.0));
        assert_eq!(median(vec![]), None);
    }
}
