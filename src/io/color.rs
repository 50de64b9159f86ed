//! False colours of disparities and of their errors.

use crate::{
    disparity::{DisparityMap, NONE},
    image::Plane,
};

/// Position on Turbo of the smallest disparity, 0 to 1; at 0 Turbo is nearly black.
const FAR: f32 = 0.05;

/// Disparity range for [`disparity_colors`], in 1/256 px: the 1st and the 99th percentile of `map`, so that a few
/// outliers do not take up all colours. `None` if the map has no disparity.
pub fn disparity_range(map: &DisparityMap) -> Option<(i32, i32)> {
    let last = known(map).count().checked_sub(1)?;
    // Rounded outwards, so that a map of a few pixels keeps its extremes.
    Some((at_place(map, last / 100), at_place(map, last - last / 100)))
}

fn known(map: &DisparityMap) -> impl Iterator<Item = i32> {
    map.data().iter().copied().filter(|&d| d != NONE)
}

/// The disparity at `place` of the sorted known disparities, counted by their upper and then by their lower 16 bits, since a
/// sorted copy takes as much memory as the map.
fn at_place(map: &DisparityMap, place: usize) -> i32 {
    /// Skips the counts before `place`, and leaves the place within the count that holds it.
    fn holder(counts: &[usize], place: &mut usize) -> i32 {
        let holds = |&count: &usize| {
            let holds = *place < count;
            if !holds {
                *place -= count;
            }
            holds
        };
        counts.iter().position(holds).map_or(0, |index| index as i32)
    }
    let mut place = place;
    let mut counts = vec![0; 1 << 16];
    let upper = |d: i32| (d >> 16) + (1 << 15);
    known(map).for_each(|d| counts[upper(d) as usize] += 1);
    let above = holder(&counts, &mut place);
    counts.fill(0);
    known(map).filter(|&d| upper(d) == above).for_each(|d| counts[(d & 0xFFFF) as usize] += 1);
    ((above - (1 << 15)) << 16) + holder(&counts, &mut place)
}

/// Colours `map` by Turbo: blue at the smallest (far) and red at the largest (near) disparity of `range`, in 1/256 px;
/// disparities outside the range are clamped to it. [`NONE`] is black.
pub fn disparity_colors(map: &DisparityMap, range: (i32, i32)) -> Plane<[u8; 3]> {
    let (low, high) = (f64::from(range.0), f64::from(range.1));
    let share = |d: i32| if high > low { ((f64::from(d) - low) / (high - low)) as f32 } else { 0.5 };
    map.map(|&d| if d == NONE { [0; 3] } else { turbo(FAR + (1.0 - FAR) * share(d).clamp(0.0, 1.0)) })
}

/// Colours of errors, each with the largest error it stands for, in pixels: from blue (small) to red (large), after the
/// diverging scheme RdYlBu of C. Brewer, <https://colorbrewer2.org>.
pub const ERROR_COLORS: [(f32, [u8; 3]); 5] = [
    (0.5, [44, 123, 182]),
    (1.0, [171, 217, 233]),
    (2.0, [255, 255, 191]),
    (4.0, [253, 174, 97]),
    (f32::INFINITY, [215, 25, 28]),
];

/// Colour of a pixel with ground truth but without an estimate.
pub const NO_ESTIMATE: [u8; 3] = [255; 3];

/// Colours the errors of `map` by [`ERROR_COLORS`] and [`NO_ESTIMATE`]. Pixels where `mask` is not 255 are occluded and
/// have a third of their brightness; pixels without ground truth are black. Disparities are in pixels; one that is not
/// finite is missing in `map` and unknown in `truth`.
///
/// # Panics
/// If the sizes differ.
pub fn error_colors(map: &Plane<f32>, truth: &Plane<f32>, mask: Option<&Plane<u8>>) -> Plane<[u8; 3]> {
    assert!(map.size() == truth.size() && mask.is_none_or(|mask| mask.size() == truth.size()), "the sizes differ");
    Plane::from_fn(truth.size(), |x, y| {
        let (found, expected) = (map.get(x, y), truth.get(x, y));
        if !expected.is_finite() {
            return [0; 3];
        }
        let error = (found - expected).abs();
        let reached = ERROR_COLORS.iter().find(|(limit, _)| error <= *limit).filter(|_| found.is_finite());
        let color = reached.map_or(NO_ESTIMATE, |&(_, color)| color);
        if mask.is_none_or(|mask| mask.get(x, y) == 255) { color } else { color.map(|channel| channel / 3) }
    })
}

/// The colour of Turbo at `t`, 0 (dark blue) to 1 (dark red), by R. Du's polynomial for A. Mikhailov's colour map:
/// 'Turbo, An Improved Rainbow Colormap for Visualization', Google AI Blog, 2019;
/// <https://gist.github.com/mikhailov-work/0d177465a8151eb6ede1768d51d476c7>.
pub fn turbo(t: f32) -> [u8; 3] {
    /// Coefficients of red, green and blue, from t^0 to t^5.
    const COEFFICIENTS: [[f32; 6]; 3] = [
        [0.135_721_38, 4.615_392_6, -42.660_324, 132.131_08, -152.942_4, 59.286_38],
        [0.091_402_61, 2.194_188_4, 4.842_966_6, -14.185_033, 4.277_298_6, 2.829_566],
        [0.106_673_3, 12.641_946, -60.582_05, 110.362_77, -89.903_11, 27.348_25],
    ];
    let t = t.clamp(0.0, 1.0);
    COEFFICIENTS.map(|c| to_byte(c.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient)))
}

fn to_byte(value: f32) -> u8 {
    // A cast saturates.
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turbo_by_hand() {
        // At 0: 255 times the constant terms; at 1: 255 times the sums of the coefficients.
        assert_eq!(turbo(0.0), [35, 23, 27]);
        assert_eq!(turbo(1.0), [144, 13, 0]);
        assert_eq!(turbo(-1.0), turbo(0.0));
        assert_eq!(turbo(2.0), turbo(1.0));
        // Blue, green and red follow one another.
        assert_eq!([0.15, 0.5, 0.85].map(|t| turbo(t).iter().enumerate().max_by_key(|c| c.1).unwrap().0), [2, 1, 0]);
    }

    #[test]
    fn no_disparity_is_nearly_black() {
        let map = DisparityMap::from_fn((1001, 1), |x, _| x as i32);
        assert!(disparity_colors(&map, (0, 1000)).data().iter().all(|rgb| rgb.iter().any(|&channel| channel > 100)));
    }

    #[test]
    fn colors_span_the_range_and_none_is_black() {
        let map = DisparityMap::new((6, 1), vec![NONE, -256, 0, 256, i32::MAX, i32::MIN + 1]).unwrap();
        let expected = [[0; 3], turbo(0.05), turbo(0.525), turbo(1.0), turbo(1.0), turbo(0.05)];
        assert_eq!(disparity_colors(&map, (-256, 256)).data(), expected);
    }

    #[test]
    fn errors_by_hand() {
        let truth = Plane::new((9, 1), vec![5.0, 5.0, 5.0, 5.0, 5.0, 5.0, f32::INFINITY, 5.0, 5.0]).unwrap();
        let map = Plane::new((9, 1), vec![5.5, 4.0, 7.0, 1.0, 9.5, f32::NAN, 5.0, 5.0, f32::INFINITY]).unwrap();
        let mask = Plane::from_fn((9, 1), |x, _| if x < 7 { 255 } else { 128 });
        let [blue, light, yellow, orange, red] = ERROR_COLORS.map(|(_, color)| color);
        let expected = [blue, light, yellow, orange, red, NO_ESTIMATE, [0; 3], [14, 41, 60], [85; 3]];
        assert_eq!(error_colors(&map, &truth, Some(&mask)).data(), expected);
        let visible = error_colors(&map, &truth, None);
        assert_eq!(visible.data()[..7], expected[..7]);
        assert_eq!(visible.data()[7..], [blue, NO_ESTIMATE]);
    }

    #[test]
    fn a_flat_map_has_one_colour() {
        let map = DisparityMap::filled((2, 2), 512);
        assert_eq!(disparity_colors(&map, disparity_range(&map).unwrap()).data(), [turbo(0.525); 4]);
    }

    #[test]
    fn range_is_the_first_and_last_percentile() {
        // The disparities 0 to 200 in mixed order, and as many pixels without a disparity.
        let map = DisparityMap::from_fn((201, 2), |x, y| if y == 0 { (x * 77 % 201) as i32 } else { NONE });
        assert_eq!(disparity_range(&map), Some((2, 198)));
        assert_eq!(disparity_range(&DisparityMap::new((3, 1), vec![5, -7, 6]).unwrap()), Some((-7, 6)));
        assert_eq!(disparity_range(&DisparityMap::filled((3, 1), NONE)), None);
        let wide = DisparityMap::new((4, 1), vec![i32::MAX, -(1 << 28), NONE, i32::MIN + 1]).unwrap();
        assert_eq!(disparity_range(&wide), Some((i32::MIN + 1, i32::MAX)));
    }
}
