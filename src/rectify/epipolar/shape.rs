//! How a homography changes shapes: aspect, skew and area.

use glam::{DMat3, DVec2};

use super::frame::{Frame, mapped};
use crate::rectify::Correspondence;

/// Number of places per side of a grid.
const GRID: u32 = 5;
/// Share of the points left out at either end.
const TAIL: f64 = 0.02;

/// The change of shapes around matched points by the homographies of both views; 1, 0 and 1 for rigid motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distortion {
    /// Largest ratio of the lengths of two strokes that had one length.
    pub aspect: f64,
    /// Largest deviation of the angle between rows and columns from 90 degrees, in degrees.
    pub skew: f64,
    /// Largest ratio of two areas that were one.
    pub area: f64,
}

impl Distortion {
    /// The distortion at the points, but for 2 % at either end; `None` if a point lies beyond the horizon.
    pub(super) fn of(maps: &[DMat3; 2], points: &[Correspondence]) -> Option<Self> {
        let (mut aspects, mut skews, mut areas) = (Vec::new(), Vec::new(), Vec::new());
        for (map, place) in points.iter().flat_map(|point| [(&maps[0], point.left), (&maps[1], point.right)]) {
            mapped(map, place)?;
            let [by_x, by_y] = jacobian(map, place);
            let area = by_x.perp_dot(by_y).abs();
            let squares = by_x.length_squared() + by_y.length_squared();
            // Singular values have the sum of squares `squares` and the product `area`.
            let ratio = squares / (2.0 * area);
            aspects.push(ratio + (ratio * ratio - 1.0).max(0.0).sqrt());
            skews.push(libm::asin((by_x.dot(by_y) / (by_x.length() * by_y.length())).clamp(-1.0, 1.0)).abs());
            areas.push(area);
        }
        let at = |values: &mut Vec<f64>, share: f64| {
            values.sort_by(f64::total_cmp);
            values.get((share * values.len().saturating_sub(1) as f64) as usize).copied()
        };
        Some(Self {
            aspect: at(&mut aspects, 1.0 - TAIL)?,
            skew: at(&mut skews, 1.0 - TAIL)?.to_degrees(),
            area: at(&mut areas, 1.0 - TAIL)? / at(&mut areas, TAIL)?,
        })
    }
}

/// Derivatives of the mapped place by the columns and by the rows of a place.
pub(super) fn jacobian(map: &DMat3, place: DVec2) -> [DVec2; 2] {
    let there = *map * place.extend(1.0);
    let at = there.truncate() / there.z;
    [map.x_axis, map.y_axis].map(|axis| (axis.truncate() - at * axis.z) / there.z)
}

/// Mapped area of a unit of area, negative for a mirror image.
pub(super) fn area(map: &DMat3, place: DVec2) -> f64 {
    let [by_x, by_y] = jacobian(map, place);
    by_x.perp_dot(by_y)
}

/// How much larger than in the view that it enlarges most, `maps` from units to pixels of the rectified plane show what is around the
/// points, in the mean; at least 1. Errors of a match in that view are enlarged by as much.
pub(super) fn enlargement(maps: &[DMat3; 2], points: &[Correspondence], frame: &Frame) -> f64 {
    let pixels = frame.map_to_pixels(0).x_axis.x;
    let of = |view: usize| {
        let places = points.iter().map(|point| [point.left, point.right][view]);
        places.map(|place| area(&maps[view], place).abs().sqrt() / pixels).sum::<f64>() / points.len().max(1) as f64
    };
    of(0).max(of(1)).max(1.0)
}

/// Places all over a view, in units, from corner to corner.
pub(super) fn grid(half: DVec2) -> impl Iterator<Item = DVec2> {
    let step = |i: u32| 2.0 * f64::from(i) / f64::from(GRID - 1) - 1.0;
    (0..GRID * GRID).map(move |i| half * DVec2::new(step(i % GRID), step(i / GRID)))
}

/// Places on the edge of a view, in pixels: half a pixel beyond the outermost ones.
pub(super) fn edge(frame: &Frame, view: usize) -> impl Iterator<Item = DVec2> {
    const STEPS: u32 = 16;
    let size = frame.sizes[view];
    let side = DVec2::new(size.width.into(), size.height.into());
    let steps = (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS));
    steps.flat_map(move |t| {
        [DVec2::new(t, 0.0), DVec2::new(t, 1.0), DVec2::new(0.0, t), DVec2::new(1.0, t)].map(|place| place * side - 0.5)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_that_is_enlarged_most_counts() {
        let frame = Frame::new([(800, 600).into(); 2], 2);
        let point = Correspondence { left: DVec2::new(0.5, -0.25), right: DVec2::ZERO };
        let of = |scales: [f64; 2]| {
            let maps = scales.map(|scale| DMat3::from_scale(DVec2::splat(400.0 * scale)));
            enlargement(&maps, &[point; 3], &frame)
        };
        assert_eq!([[1.0, 1.0], [0.5, 0.8], [1.0, 2.5], [3.0, 1.5]].map(of), [1.0, 1.0, 2.5, 3.0]);
    }

    #[test]
    fn distortion_by_hand() {
        let at = |map: DMat3| {
            let point = Correspondence { left: DVec2::new(0.5, -0.25), right: DVec2::ZERO };
            Distortion::of(&[map, DMat3::IDENTITY], &[point; 50])
        };
        let turned = at(DMat3::from_angle(0.7)).unwrap();
        assert!((turned.aspect - 1.0).abs() < 1e-6 && turned.skew < 1e-6 && (turned.area - 1.0).abs() < 1e-9);
        let stretched = at(DMat3::from_scale(DVec2::new(1.0, 3.0))).unwrap();
        assert!((stretched.aspect - 3.0).abs() < 1e-9 && stretched.skew < 1e-9 && (stretched.area - 3.0).abs() < 1e-9);
        // Rows stay level and columns lean by 1 in 1.
        let sheared = at(DMat3::from_cols_array(&[1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0])).unwrap();
        assert!((sheared.skew - 45.0).abs() < 1e-9 && (sheared.area - 1.0).abs() < 1e-9, "{sheared:?}");
        let beyond = DMat3::from_cols_array(&[1.0, 0.0, -4.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(at(beyond), None, "1 - 4 * 0.5 is negative");
    }
}
