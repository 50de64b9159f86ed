//! Parallax across the rows: how far rows of the views differ with the disparity.

use super::Correspondence;

/// Number of points that are looked at, the most certain ones.
const POINTS: usize = 600;
/// Largest row error of a point that is looked at, and largest distance of two points that are compared, as shares of the extent of all
/// points.
const FAR: f64 = 0.1;
const NEAR: f64 = 0.15;
/// Smallest difference of the disparities of two points that are compared, in pixels, and the largest as a share of the extent.
const LEAST: f64 = 3.0;
const MOST: f64 = 0.3;
/// Smallest number of compared pairs of points from which a climb is told.
const FEW: usize = 200;
/// Smallest climb that is clear, and how many times as many pairs must agree with it as with none: nine scenes as they are, and two of them
/// scaled, sheared, cropped, seen through lenses and in perspective have up to 0.14 and 1.04, five with both views turned by 10 degrees at
/// least 0.10 and 1.13, by 5 degrees 0.05 and 1.04 (measured with 1500 points and affine rows).
const CLEAR: f64 = 0.05;
const GAIN: f64 = 1.1;

/// The row difference per pixel of disparity that most points share: of cameras that stand side by side it is 0, whatever they see; of
/// cameras whose baseline slants in the pictures its tangent, and no warp of the rows brings these together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Climb {
    /// Rows per pixel of disparity.
    pub rows: f64,
    /// How many times as many pairs of points agree with the climb as with none.
    gain: f64,
}

impl Climb {
    /// The climb that `points` show, the most certain first, whose rows differ by `errors` from those of a model. `None` if too few
    /// differ in disparity.
    ///
    /// Neighbours are compared, and not points with a common plane: the ground is near at the bottom of most pictures, so that a
    /// warp of the rows takes a part of the parallax away.
    pub fn of(points: &[Correspondence], errors: &[f64]) -> Option<Self> {
        let all = &points[..points.len().min(POINTS)];
        let sides = |side: fn(&Correspondence) -> f64| {
            let (least, most) = all.iter().map(side).fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(c), b.max(c)));
            most - least
        };
        let extent = sides(|point| point.right.x).max(sides(|point| point.right.y));
        let kept: Vec<(&Correspondence, f64)> =
            all.iter().zip(errors.iter().copied()).filter(|(_, error)| error.abs() <= FAR * extent).collect();
        let disparity = |point: &Correspondence| point.left.x - point.right.x;
        let mut differences = Vec::new();
        for (index, (a, error)) in kept.iter().enumerate() {
            for (b, other) in &kept[index + 1..] {
                let (rows, columns) = (error - other, disparity(a) - disparity(b));
                let is_near = (a.right - b.right).length() <= NEAR * extent;
                if is_near && (LEAST..=MOST * extent).contains(&columns.abs()) {
                    differences.push((rows, columns));
                }
            }
        }
        if differences.len() < FEW {
            return None;
        }
        let agreeing = |climb: f64| -> f64 {
            differences.iter().map(|(rows, columns)| 1.0 / (1.0 + (rows - climb * columns).powi(2))).sum()
        };
        let best = |among: &mut dyn Iterator<Item = f64>| {
            let counted = among.map(|climb| (climb, agreeing(climb)));
            counted.max_by(|a, b| a.1.total_cmp(&b.1)).expect("some climbs")
        };
        let (coarse, _) = best(&mut (-20..=20).map(|step| f64::from(step) * 0.05));
        let (rows, most) = best(&mut (-5..=5).map(|step| coarse + f64::from(step) * 0.01));
        Some(Self { rows, gain: most / agreeing(0.0) })
    }

    /// Whether the baseline slants, and not a few points.
    pub fn is_clear(&self) -> bool {
        self.rows.abs() >= CLEAR && self.gain >= GAIN
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Points of 40 depths and their row errors, with parallax across the rows.
    fn climb(rows: f64, depths: u32) -> Option<Climb> {
        let point = |i: u32| {
            let right = DVec2::new(f64::from(i * 197 % 600), f64::from(i * 331 % 440));
            let disparity = f64::from(i * 7 % depths);
            let wrong = if i.is_multiple_of(3) { f64::from(i * 53 % 40) - 20.0 } else { 0.0 };
            let error = rows * disparity + f64::from(i * 29 % 11) / 15.0 - 1.0 / 3.0 + wrong;
            (Correspondence { left: right + DVec2::new(disparity, error), right }, error)
        };
        let (points, errors): (Vec<_>, Vec<_>) = (0..150).map(point).unzip();
        Climb::of(&points, &errors)
    }

    #[test]
    fn a_slanting_baseline_is_told_from_one_along_the_rows() {
        for rows in [0.1, -0.27, 0.8] {
            let found = climb(rows, 40).unwrap();
            assert!(found.is_clear() && (found.rows - rows).abs() < 0.02, "{rows}: {found:?}");
        }
        let level = climb(0.0, 40).unwrap();
        assert!(!level.is_clear() && level.rows.abs() < 0.03, "{level:?}");
        assert_eq!(climb(0.3, 3), None, "disparities that do not differ");
    }
}
