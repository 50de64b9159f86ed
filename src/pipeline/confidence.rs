//! Confidences that are too high for what the views and the whole map show.

use super::trust::TRUSTED;
use crate::{
    dense::{Dense, FILLED},
    disparity::DisparityRange,
    filter::{CELL, detail},
    image::{Luma, Size},
};

/// Detail along rows and along columns, in thousandths, below which confidences are reduced most, and from which they stay. Blur by
/// motion of 9 or 17 px, or of 4 px out of focus, leaves 250 to 320 of 400 to 700 along rows; roads and shades have as little.
const DETAIL: [[u32; 2]; 2] = [[280, 400], [250, 310]];
/// Part of the confidence that a measured pixel without detail keeps, in 1/256.
const WITHOUT_DETAIL: u32 = 128;
/// Part of the confidences in a map that is not trusted, in 1/256: with a trust of 0, where confidences still tell better pixels from
/// worse, and just below [`TRUSTED`], where none reaches 192.
const UNTRUSTED: [u32; 2] = [26, 180];
/// Pixels on either side of a pixel that its census transform sees.
const CONSTANT: u32 = 2;

/// The map with confidence 0 where a disparity lies at an end of `range`, beyond which it may go on.
pub(super) fn without_ends(mut dense: Dense, range: DisparityRange, ends_at_zero: bool) -> Dense {
    let Size { width, height } = dense.disparity.size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let [low, high] = range.is_at_end(dense.disparity.get(x, y));
        if low && !ends_at_zero || high {
            dense.confidence.set(x, y, 0);
        }
    }
    dense
}

/// The map of `view` with confidence 0 where the view is constant around a pixel, as where it is overexposed: such a pixel costs
/// the same with all disparities whose partner is alike, and only its surroundings tell which it has.
pub(super) fn without_constant(mut dense: Dense, view: &Luma) -> Dense {
    let Size { width, height } = view.size();
    let around = |at: u32, length: u32| at.saturating_sub(CONSTANT)..length.min(at + CONSTANT + 1);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let own = view.get(x, y);
        if around(y, height).all(|j| around(x, width).all(|i| view.get(i, j) == own)) {
            dense.confidence.set(x, y, 0);
        }
    }
    dense
}

/// The map of `view` with measured pixels reduced where the view has little detail: a blurred edge, of what moves or is out of focus,
/// fits at the disparities of both of its sides.
pub(super) fn by_detail(mut dense: Dense, view: &Luma) -> Dense {
    let parts = detail(view).map(|&detail| part_by_detail(detail));
    let Size { width, height } = view.size();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let confidence = dense.confidence.get(x, y);
        if confidence > FILLED {
            dense.confidence.set(x, y, reduced(confidence, parts.get(x / CELL, y / CELL)));
        }
    }
    dense
}

/// Part of the confidence of a measured pixel with `detail` along rows and along columns around it, in 1/256.
fn part_by_detail(detail: [u32; 2]) -> u32 {
    let parts = detail.into_iter().zip(DETAIL);
    let parts =
        parts.map(|(detail, [none, full])| (256 - WITHOUT_DETAIL) * (detail.clamp(none, full) - none) / (full - none));
    WITHOUT_DETAIL + parts.min().expect("two directions")
}

/// The map with confidences in proportion to `trust`, where that is below [`TRUSTED`]: a map that is not trusted has no high ones.
pub(super) fn in_proportion(mut dense: Dense, trust: f32) -> Dense {
    if trust < TRUSTED {
        let part = (UNTRUSTED[1] as f32 * trust / TRUSTED) as u32;
        let part = part.max(UNTRUSTED[0]);
        dense.confidence.data_mut().iter_mut().for_each(|value| *value = reduced(*value, part));
    }
    dense
}

/// A confidence reduced to `part` of 256 within its kind: measured pixels stay above filled ones, and filled ones above those of which
/// nothing is known.
fn reduced(confidence: u8, part: u32) -> u8 {
    let least = match confidence {
        0 => 0,
        1..=FILLED => 1,
        _ => FILLED + 1,
    };
    least + (u32::from(confidence - least) * part / 256) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{disparity::SCALE, image::Plane};

    /// A map of two halves, 10 and 20 px, with `confidence` everywhere.
    fn map(confidence: u8) -> Dense {
        Dense {
            disparity: Plane::from_fn((40, 10), |x, _| if x < 20 { 10 * SCALE } else { 20 * SCALE }),
            confidence: Plane::filled((40, 10), confidence),
        }
    }

    #[test]
    fn an_end_has_no_confidence_unless_it_is_zero() {
        let range = |min, last| DisparityRange::inclusive(min, last).unwrap();
        let halves = |dense: Dense| [dense.confidence.get(0, 0), dense.confidence.get(39, 0)];
        assert_eq!(halves(without_ends(map(90), range(8, 22), false)), [90, 90]);
        assert_eq!(halves(without_ends(map(90), range(9, 22), false)), [0, 90]);
        assert_eq!(halves(without_ends(map(90), range(9, 21), true)), [90, 0]);
    }

    #[test]
    fn constant_areas_have_no_confidence() {
        // Constant from column 10 on, but for one pixel.
        let view =
            Luma::from_fn((40, 10), |x, y| if x < 10 { (37 * x + 59 * y) as u8 } else { 255 - 9 * u8::from(x == 30) });
        let confidence = without_constant(map(90), &view).confidence;
        for x in 0..40 {
            let is_constant = x >= 12 && !(28..=32).contains(&x);
            assert_eq!(confidence.get(x, 5), if is_constant { 0 } else { 90 }, "column {x}");
        }
    }

    #[test]
    fn confidences_follow_a_small_trust() {
        let confidence = |value, trust| in_proportion(map(value), trust).confidence.get(0, 0);
        assert_eq!([0.5, 0.499, 0.25, 0.0].map(|trust| confidence(216, trust)), [216, 155, 86, 36]);
        assert!(confidence(255, 0.499) < 192);
        assert_eq!([0, 1, FILLED, FILLED + 1].map(|value| confidence(value, 0.0)), [0, 1, 2, FILLED + 1]);
        assert_eq!(confidence(FILLED, 0.25), 5);
    }

    #[test]
    fn measured_pixels_without_detail_are_less_sure() {
        // Noise, and the same in one value per 8x8 pixels.
        let texture = |x: u32, y: u32| (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 24;
        let of = |value: u8, size: u32| {
            let view = Luma::from_fn((40, 10), |x, y| texture(x / size, y / size) as u8);
            by_detail(map(value), &view).confidence.get(20, 5)
        };
        assert_eq!([of(216, 1), of(216, 8)], [216, 116]);
        assert_eq!([0, FILLED, FILLED + 1].map(|value| of(value, 8)), [0, FILLED, FILLED + 1]);
        // Rows of 0.34 and columns of 0.28 are half way.
        assert_eq!([[280, 310], [340, 310], [340, 280], [400, 280]].map(part_by_detail), [128, 192, 192, 192]);
    }
}
