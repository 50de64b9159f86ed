//! Matches moved to where windows of both views agree best: least squares matching (Gruen, South African Journal of
//! Photogrammetry, Remote Sensing and Cartography 14, 1985), in the inverse compositional form (Baker and Matthews, International
//! Journal of Computer Vision 56, 2004).
//!
//! The position of an interest point is as exact as its scale, and a structure that is seen obliquely has it elsewhere in each view. A
//! window has the same structure in both, but for an affine map, brightness and contrast.

use std::sync::LazyLock;

use glam::{DMat2, DVec2};

use crate::{
    image::Luma,
    rectify::{Correspondence, cholesky::solved},
};

/// Half the side of a window, in pixels.
const HALF: i32 = 10;
/// Standard deviation of the Gaussian that weights a window, in pixels.
const SIGMA: f64 = 5.0;
/// Largest number of steps.
const STEPS: usize = 15;
/// Steps end when the centre moves by less, in pixels.
const SETTLED: f64 = 0.01;
/// Longest way from the interest point, in pixels.
const FARTHEST: f64 = 3.0;
/// Smallest correlation of the windows.
const ALIKE: f64 = 0.8;
/// Smallest and largest ratio of areas of the windows.
const AREAS: std::ops::Range<f64> = 0.4..2.5;
/// Smallest length of the weighted levels of a window without their mean, in grey levels: a window is flat below.
const FLAT: f64 = 10.0;
/// Smallest share of a diagonal element of the normal equations that has to remain: stripes do not tell a place along them.
const SINGULAR: f64 = 1e-3;

/// The places of a window around its centre, in pixels, with the square root of their weights.
static PLACES: LazyLock<Vec<(DVec2, f64)>> = LazyLock::new(|| {
    let places = (-HALF..=HALF).flat_map(|y| (-HALF..=HALF).map(move |x| DVec2::new(x.into(), y.into())));
    places.map(|place| (place, libm::exp(-place.length_squared() / (4.0 * SIGMA * SIGMA)))).collect()
});

/// Moves the point of the right view to where the window there agrees best with the window around the point of the left view. Both
/// stay where the windows do not agree, leave the views, or have no structure in both directions.
pub(super) fn refined(views: [&Luma; 2], point: Correspondence) -> Correspondence {
    let right = Window::new(views[0], point.left).and_then(|window| window.place_in(views[1], point.right));
    Correspondence { right: right.unwrap_or(point.right), ..point }
}

/// A window, and how a small affine map changes it.
struct Window {
    levels: Vec<f64>,
    /// Derivatives of the levels by a shift (x, y) and by the four elements of the matrix, row by row, in all of which brightness and
    /// contrast are left out.
    slopes: Vec<[f64; 6]>,
    /// Lower triangle of the normal equations.
    normal: [[f64; 6]; 6],
}

impl Window {
    fn new(view: &Luma, centre: DVec2) -> Option<Self> {
        let at = |offset: DVec2| level(view, centre + offset);
        let Normalised { values: levels, length } =
            Normalised::new(PLACES.iter().map(|&(offset, _)| at(offset)).collect::<Option<Vec<f64>>>()?)?;
        let slope = |&(offset, weight): &(DVec2, f64)| {
            let along = |step: DVec2| Some(weight * (at(offset + step)? - at(offset - step)?) / (2.0 * length));
            let (x, y) = (along(DVec2::X)?, along(DVec2::Y)?);
            Some([x, y, x * offset.x, x * offset.y, y * offset.x, y * offset.y])
        };
        let mut slopes = PLACES.iter().map(slope).collect::<Option<Vec<_>>>()?;
        let square: f64 = PLACES.iter().map(|(_, weight)| weight * weight).sum();
        let mut normal = [[0.0; 6]; 6];
        for i in 0..6 {
            let (mut brightness, mut contrast) = (0.0, 0.0);
            for ((slope, (_, weight)), level) in slopes.iter().zip(&*PLACES).zip(&levels) {
                brightness += slope[i] * weight / square;
                contrast += slope[i] * level;
            }
            for ((slope, (_, weight)), level) in slopes.iter_mut().zip(&*PLACES).zip(&levels) {
                slope[i] -= brightness * weight + contrast * level;
            }
            for j in 0..=i {
                normal[i][j] = slopes.iter().map(|slope| slope[i] * slope[j]).sum();
            }
        }
        Some(Self { levels, slopes, normal })
    }

    /// The place of another view around which its levels agree best with the window, from `start` on.
    fn place_in(&self, view: &Luma, start: DVec2) -> Option<DVec2> {
        let (mut place, mut shape) = (start, DMat2::IDENTITY);
        for _ in 0..STEPS {
            let seen = PLACES.iter().map(|&(offset, _)| level(view, place + shape * offset));
            let seen = Normalised::new(seen.collect::<Option<Vec<f64>>>()?)?.values;
            let (mut moment, mut correlation) = ([0.0; 6], 0.0);
            for ((seen, level), slope) in seen.iter().zip(&self.levels).zip(&self.slopes) {
                correlation += seen * level;
                for (sum, slope) in moment.iter_mut().zip(slope) {
                    *sum += slope * (seen - level);
                }
            }
            let [x, y, xx, xy, yx, yy] = solved(self.normal, moment, 6, SINGULAR)?;
            let step = DMat2::from_cols(DVec2::new(1.0 + xx, yx), DVec2::new(xy, 1.0 + yy));
            if !AREAS.contains(&step.determinant()) {
                return None;
            }
            shape *= step.inverse();
            let moved = shape * DVec2::new(x, y);
            place -= moved;
            if !AREAS.contains(&shape.determinant()) || place.distance(start) > FARTHEST {
                return None;
            }
            if moved.length() < SETTLED {
                return (correlation >= ALIKE).then_some(place);
            }
        }
        None
    }
}

/// Weighted levels without their mean, and of length 1.
struct Normalised {
    values: Vec<f64>,
    /// Their length before, in grey levels.
    length: f64,
}

impl Normalised {
    /// `None` where all levels are equal.
    fn new(mut values: Vec<f64>) -> Option<Self> {
        let (mut sum, mut square) = (0.0, 0.0);
        for (value, (_, weight)) in values.iter().zip(&*PLACES) {
            sum += value * weight * weight;
            square += weight * weight;
        }
        for (value, (_, weight)) in values.iter_mut().zip(&*PLACES) {
            *value = (*value - sum / square) * weight;
        }
        let length = values.iter().map(|value| value * value).sum::<f64>().sqrt();
        values.iter_mut().for_each(|value| *value /= length);
        (length > FLAT).then_some(Self { values, length })
    }
}

/// The level at a place, interpolated between its four neighbours; `None` outside the view.
fn level(view: &Luma, place: DVec2) -> Option<f64> {
    let last = DVec2::new(view.width().into(), view.height().into()) - 1.0;
    if !(place.cmpge(DVec2::ZERO).all() && place.cmple(last).all()) {
        return None;
    }
    let corner = place.floor();
    let part = place - corner;
    let (x, y) = (corner.x as i64, corner.y as i64);
    let row = |y: i64| {
        let [left, right] = [x, x + 1].map(|x| f64::from(view.get_clamped(x, y)));
        left + part.x * (right - left)
    };
    let [above, below] = [row(y), row(y + 1)];
    Some(above + part.y * (below - above))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Plane;

    /// A view of waves of several directions, seen through an affine map with brightness and contrast.
    fn view(waves: &[[f64; 2]], shape: DMat2, shift: DVec2) -> Luma {
        Plane::from_fn((60, 60), |x, y| {
            let place = shape * (DVec2::new(x.into(), y.into()) - 30.0) + shift;
            let level: f64 = waves.iter().map(|&[x, y]| libm::sin(DVec2::new(x, y).dot(place))).sum();
            (128.0 + 90.0 / waves.len() as f64 * level).round() as u8
        })
    }

    const ALL: [[f64; 2]; 4] = [[0.5, 0.1], [-0.2, 0.45], [0.31, -0.27], [0.13, 0.22]];

    #[test]
    fn a_point_moves_to_where_the_windows_agree() {
        let shape = DMat2::from_cols(DVec2::new(1.1, -0.06), DVec2::new(0.08, 0.93));
        let shift = DVec2::new(1.3, -0.8);
        let (left, right) = (view(&ALL, DMat2::IDENTITY, DVec2::ZERO), view(&ALL, shape, shift));
        let right = right.map(|&level| (level / 2) + 40);
        let centre = DVec2::splat(30.0);
        let point = Correspondence { left: centre, right: centre };
        let found = refined([&left, &right], point);
        assert_eq!(found.left, centre);
        let truth = centre - shape.inverse() * shift;
        assert!(found.right.distance(truth) < 0.03, "{} {truth}", found.right);
    }

    #[test]
    fn what_the_windows_do_not_tell_stays() {
        let centre = DVec2::splat(30.0);
        let point = |right: DVec2| Correspondence { left: centre, right };
        let left = view(&ALL, DMat2::IDENTITY, DVec2::ZERO);
        let moved = DVec2::new(30.7, 29.6);
        // Something else, a view that is flat, an edge of the view, and a structure of one direction.
        let other = view(&[[0.4, 0.4], [0.1, -0.5]], DMat2::IDENTITY, DVec2::ZERO);
        assert_eq!(refined([&left, &other], point(moved)), point(moved));
        assert_eq!(refined([&left, &Plane::filled((60, 60), 9)], point(moved)), point(moved));
        let edge = DVec2::new(5.0, 30.0);
        assert_eq!(refined([&left, &left], point(edge)), point(edge));
        let stripes = view(&ALL[..1], DMat2::IDENTITY, DVec2::ZERO);
        assert_eq!(refined([&stripes, &stripes], point(moved)), point(moved));
        assert!(refined([&left, &left], point(moved)).right.distance(centre) < 0.01, "what is told is found");
    }
}
