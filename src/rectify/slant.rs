//! Slant of the columns: how the disparity changes from place to place on most surfaces.

use glam::DVec2;

use super::{Correspondence, cholesky::solved};

/// Number of points that are looked at, the most certain ones.
const POINTS: usize = 1500;
/// Number of neighbours that a point is compared with.
const NEIGHBOURS: usize = 8;
/// Distances of neighbours, as shares of the extent of all points.
const DISTANCES: std::ops::Range<f64> = 0.02..0.1;
/// Widths of the Cauchy loss, in pixels, the widest first.
const WIDTHS: [f64; 4] = [8.0, 4.0, 2.0, 1.0];
/// Steps per width.
const STEPS: usize = 12;
/// Smallest number of neighbours from which a slant is told.
const FEW: usize = 60;
/// Smallest slant that is clear, along either axis, and its smallest share of the cost: twenty scenes as they are, without a cylinder, have
/// up to 0.044 and 0.23, seven with columns sheared by 0.15 at least 0.08 and 0.08.
const CLEAR: f64 = 0.05;
const EXPLAINED: f64 = 0.05;

/// The change of the disparity per pixel of the right view that most surfaces share.
///
/// Surfaces that face the cameras have none, and most scenes show as many that rise as fall: of twenty scenes none has more than
/// 0.044. Columns that a shear or a stretch separates from those of the left view give their own slant to all surfaces, and
/// semi-global matching, which prefers equal disparities in the neighbourhood, loses what has no texture (Scharstein, Taniai and Sinha,
/// Semi-Global Matching with Surface Orientation Priors, 3DV 2017).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slant {
    /// Per column and per row.
    pub along: [f64; 2],
    /// Share of the cost of the neighbours' differences that the slant explains, 0 to 1.
    pub explained: f64,
}

impl Slant {
    /// The slant that `points` show whose rows correspond, the most certain first, in units of `unit` pixels. `None` if too few have
    /// neighbours.
    ///
    /// Differences between neighbours, and not the points themselves, are what a slant is fitted to: the ground is near at the bottom
    /// of most pictures, and yet most surfaces stand upright.
    pub fn of(points: &[Correspondence], unit: f64) -> Option<Self> {
        let points = &points[..points.len().min(POINTS)];
        let differences = differences(points, unit);
        if differences.len() < FEW {
            return None;
        }
        let along = WIDTHS.into_iter().try_fold([0.0; 2], |along, width| refined(along, &differences, width))?;
        let [_, .., width] = WIDTHS;
        let cost = |along| -> f64 {
            let deviations = differences.iter().map(|difference| difference.deviation(along) / width);
            deviations.map(|deviation| libm::log1p(deviation * deviation)).sum()
        };
        let before = cost([0.0; 2]);
        Some(Self { along, explained: if before > 0.0 { 1.0 - cost(along) / before } else { 0.0 } })
    }

    /// Whether columns of the views differ, and not a few surfaces.
    pub fn is_clear(&self) -> bool {
        self.along.iter().any(|slope| slope.abs() > CLEAR) && self.explained > EXPLAINED
    }
}

/// How two points that are neighbours in the right view differ, in pixels.
struct Difference {
    step: DVec2,
    disparity: f64,
}

impl Difference {
    /// The difference of the disparities that a slant leaves.
    fn deviation(&self, [across, down]: [f64; 2]) -> f64 {
        self.disparity - across * self.step.x - down * self.step.y
    }
}

/// Differences of each point and its neighbours; a pair of points counts once.
fn differences(points: &[Correspondence], unit: f64) -> Vec<Difference> {
    let (least, most) = points
        .iter()
        .map(|point| (point.right, point.right))
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), (c, d)| (a.min(c), b.max(d)));
    let extent = (most - least).max_element();
    let range = DISTANCES.start * extent..DISTANCES.end * extent;
    let near: Vec<Vec<usize>> = points
        .iter()
        .map(|from| {
            let distance = |to: &Correspondence| (to.right - from.right).length();
            let mut near: Vec<(f64, usize)> = points
                .iter()
                .enumerate()
                .map(|(index, to)| (distance(to), index))
                .filter(|(d, _)| range.contains(d))
                .collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            near.into_iter().take(NEIGHBOURS).map(|(_, index)| index).collect()
        })
        .collect();
    let disparity = |point: &Correspondence| point.left.x - point.right.x;
    let once = |from: usize, to: usize| from < to || !near[to].contains(&from);
    let pairs = (0..points.len()).flat_map(|from| near[from].iter().map(move |&to| (from, to)));
    pairs
        .filter(|&(from, to)| once(from, to))
        .map(|(from, to)| {
            let (from, to) = (&points[from], &points[to]);
            let (step, disparity) = (to.right - from.right, disparity(to) - disparity(from));
            Difference { step: step * unit, disparity: disparity * unit }
        })
        .collect()
}

/// Least squares with Cauchy weights, from a slant that wider weights gave. `None` if all points lie on a line.
fn refined(start: [f64; 2], differences: &[Difference], width: f64) -> Option<[f64; 2]> {
    const SINGULAR: f64 = 1e-9;
    (0..STEPS).try_fold(start, |along, _| {
        let (mut normal, mut moment) = ([[0.0; 2]; 2], [0.0; 2]);
        for difference in differences {
            let deviation = difference.deviation(along) / width;
            let weight = 1.0 / (1.0 + deviation * deviation);
            let step = difference.step.to_array();
            for i in 0..2 {
                moment[i] += weight * step[i] * difference.disparity;
                (0..2).for_each(|j| normal[i][j] += weight * step[i] * step[j]);
            }
        }
        solved(normal, moment, 2, SINGULAR)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Surfaces of 80 x 80 px at several disparities, each with its own slant, in a right view whose columns are stretched and
    /// sheared; every fifth point is wrong.
    fn points(slants: &[f64], across: f64, down: f64) -> Vec<Correspondence> {
        (0..500)
            .map(|i| {
                let right = DVec2::new(f64::from(i * 197 % 640), f64::from(i * 331 % 480));
                let surface = (right / 80.0).floor();
                let which = surface.x as usize + 8 * surface.y as usize;
                let own = 7.0 * (which * 5 % 11) as f64 + slants[which % slants.len()] * (right.y - 80.0 * surface.y);
                let wrong = if i % 5 == 0 { f64::from(i * 53 % 90) - 45.0 } else { 0.0 };
                let disparity = 20.0 + own + across * right.x + down * right.y + wrong;
                Correspondence { left: right + DVec2::new(disparity, 0.0), right }
            })
            .collect()
    }

    #[test]
    fn a_stretch_and_a_shear_of_the_columns_are_told() {
        for (across, down) in [(0.0, 0.0), (0.0, 0.15), (0.0, -0.3), (0.1, 0.0), (-0.2, 0.25)] {
            let found = Slant::of(&points(&[0.0], across, down), 1.0).unwrap();
            assert!((found.along[0] - across).abs() < 0.01 && (found.along[1] - down).abs() < 0.01, "{found:?}");
            assert_eq!(found.is_clear(), across != 0.0 || down != 0.0, "{found:?}");
        }
    }

    #[test]
    fn surfaces_of_all_slants_show_none_in_common() {
        let found = Slant::of(&points(&[0.0, 0.3, -0.25, 0.0, -0.4, 0.2], 0.0, 0.0), 1.0).unwrap();
        assert!(!found.is_clear(), "{found:?}");
    }

    #[test]
    fn the_unit_and_the_number_of_points_do_not_matter() {
        let all = points(&[0.0], 0.0, 0.15);
        let small: Vec<_> =
            all.iter().map(|point| Correspondence { left: point.left / 320.0, right: point.right / 320.0 }).collect();
        let (a, b) = (Slant::of(&all, 1.0).unwrap(), Slant::of(&small, 320.0).unwrap());
        assert!((a.along[1] - b.along[1]).abs() < 1e-3, "{a:?} {b:?}");
        assert_eq!(Slant::of(&all[..10], 1.0), None);
        assert_eq!(Slant::of(&[], 1.0), None);
        let line: Vec<_> =
            all.iter().map(|point| Correspondence { right: point.right.with_x(0.0), ..*point }).collect();
        assert_eq!(Slant::of(&line, 1.0), None, "a column tells nothing of the others");
    }
}
