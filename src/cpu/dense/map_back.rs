//! The map of a warped picture as one of another picture, from the definition.

use glam::{I64Vec2, IVec2};

use crate::{
    dense::{Dense, kernels::SURFACE},
    disparity::NONE,
    image::{Plane, Size},
    rectify::{SUBPIXEL_BITS, WarpMap},
};

/// The map of a picture whose pixels lie where `back` says in the picture that `dense` belongs to.
///
/// Of the four pixels around a position, weighted as bilinear interpolation does, those within 1 px of the one for which they weigh most
/// make the disparity, rounded to the nearest, halves up; the heaviest of these has the confidence. Of equal ones the first counts, row
/// by row.
pub fn map_back(dense: &Dense, back: &WarpMap) -> Dense {
    debug_assert_eq!(dense.disparity.size(), back.source_size());
    let found = Plane::from_fn(back.size(), |x, y| {
        let position = back.source_at(x, y).filter(|&position| is_inside(position, back.source_size()));
        position.and_then(|position| surface(dense, position)).unwrap_or((NONE, 0))
    });
    Dense { disparity: found.map(|&(disparity, _)| disparity), confidence: found.map(|&(_, confidence)| confidence) }
}

/// Whether a position lies in a pixel of a picture.
fn is_inside(position: IVec2, size: Size) -> bool {
    let pixel = (position.as_i64vec2() + (1 << (SUBPIXEL_BITS - 1))) >> SUBPIXEL_BITS;
    let side = I64Vec2::new(size.width.into(), size.height.into());
    pixel.cmpge(I64Vec2::ZERO).all() && pixel.cmplt(side).all()
}

/// A pixel around a position.
#[derive(Clone, Copy)]
struct Neighbour {
    weight: i64,
    disparity: i32,
    confidence: u8,
}

/// Disparity and confidence at a position between pixels; `None` between unknown ones.
fn surface(dense: &Dense, position: IVec2) -> Option<(i32, u8)> {
    let first = position >> SUBPIXEL_BITS;
    let part = (position - (first << SUBPIXEL_BITS)).as_i64vec2();
    let rest = (1 << SUBPIXEL_BITS) - part;
    let weights = [(0, 0, rest.x * rest.y), (1, 0, part.x * rest.y), (0, 1, rest.x * part.y), (1, 1, part.x * part.y)];
    let known: Vec<Neighbour> = weights
        .into_iter()
        .map(|(i, j, weight)| {
            let (x, y) = ((first.x + i).into(), (first.y + j).into());
            let (disparity, confidence) = (dense.disparity.get_clamped(x, y), dense.confidence.get_clamped(x, y));
            Neighbour { weight, disparity, confidence }
        })
        .filter(|neighbour| neighbour.weight > 0 && neighbour.disparity != NONE)
        .collect();
    let beside = |one: &Neighbour| {
        let from = one.disparity;
        known.iter().filter(move |other| other.disparity.abs_diff(from) <= SURFACE.unsigned_abs())
    };
    let weight = |one: &Neighbour| -> i64 { beside(one).map(|other| other.weight).sum() };
    // `max_by_key` takes the last of equal ones.
    let best = known.iter().rev().max_by_key(|one| weight(one))?;
    let off = |other: &Neighbour| i64::from(other.disparity) - i64::from(best.disparity);
    let sum: i64 = beside(best).map(|other| other.weight * off(other)).sum();
    let mean = (sum + weight(best) / 2).div_euclid(weight(best));
    let first_heaviest = |a: &&Neighbour, b: &&Neighbour| a.weight.cmp(&b.weight).then(std::cmp::Ordering::Greater);
    let heaviest = beside(best).max_by(first_heaviest)?;
    Some(((i64::from(best.disparity) + mean) as i32, heaviest.confidence))
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn disparities_lie_between_neighbours_of_one_surface() {
        let dense = Dense {
            disparity: Plane::new((4, 1), vec![100, 200, 1000, NONE]).unwrap(),
            confidence: Plane::new((4, 1), vec![10, 20, 30, 40]).unwrap(),
        };
        let back = WarpMap::new((5, 1), (4, 1), |p| p - DVec2::new(0.75, 0.0)).unwrap();
        // At -0.75 nothing is shown; 0.25 lies between 100 and 200, 1.25 at an edge, 2.25 beside a hole, 3.25 in it.
        let found = map_back(&dense, &back);
        assert_eq!(found.disparity.data(), [NONE, 125, 200, 1000, NONE]);
        assert_eq!(found.confidence.data(), [0, 10, 20, 30, 0]);
        // 0.6 is closer to the second pixel, 2.6 to a hole, which does not reach as far as the pixel before it.
        let dense = Dense { disparity: Plane::new((4, 1), vec![100, 1000, 1100, NONE]).unwrap(), ..dense };
        let found = map_back(&dense, &WarpMap::new((5, 1), (4, 1), |p| p - DVec2::new(0.4, 0.0)).unwrap());
        assert_eq!(found.disparity.data(), [100, 1000, 1060, 1100, NONE]);
        assert_eq!(found.confidence.data(), [10, 20, 30, 30, 0]);
    }

    #[test]
    fn the_heaviest_surface_counts_and_not_the_nearest_pixel() {
        let dense = Dense {
            disparity: Plane::new((2, 2), vec![1000, 100, 100, 104]).unwrap(),
            confidence: Plane::new((2, 2), vec![1, 2, 3, 4]).unwrap(),
        };
        // Weights 0.36, 0.24, 0.24 and 0.16: (24 * 100 + 24 * 100 + 16 * 104) / 64 = 101.
        let found = map_back(&dense, &WarpMap::new((1, 1), (2, 2), |p| p + 0.4).unwrap());
        assert_eq!((found.disparity.data(), found.confidence.data()), (&[101][..], &[2][..]));
    }
}
