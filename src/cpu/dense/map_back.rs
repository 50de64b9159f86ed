//! The map of a warped picture as one of another picture, from the definition.

use glam::{I64Vec2, IVec2};

use crate::{
    dense::{Dense, kernels::SURFACE},
    disparity::{DisparityMap, NONE},
    image::{Plane, Size},
    rectify::{SUBPIXEL_BITS, WarpMap},
};

/// The map of a picture whose pixels lie where `back` says in the picture that `dense` belongs to. Disparities are interpolated
/// bilinearly between the four pixels around a position, rounded to the nearest, halves up, where all have one and none differs
/// by more than 1 px, and are else those of the nearest pixel; confidences are those of the nearest pixel.
pub fn map_back(dense: &Dense, back: &WarpMap) -> Dense {
    debug_assert_eq!(dense.disparity.size(), back.source_size());
    let shown = Plane::from_fn(back.size(), |x, y| {
        let position = back.source_at(x, y)?;
        Some((position, nearest(position, back.source_size())?))
    });
    Dense {
        disparity: shown.map(|shown| {
            shown.map_or(NONE, |(position, (x, y))| {
                interpolated(&dense.disparity, position).unwrap_or_else(|| dense.disparity.get(x, y))
            })
        }),
        confidence: shown.map(|shown| shown.map_or(0, |(_, (x, y))| dense.confidence.get(x, y))),
    }
}

/// The pixel of a picture nearest to a position; `None` outside the picture.
fn nearest(position: IVec2, size: Size) -> Option<(u32, u32)> {
    let pixel = (position.as_i64vec2() + (1 << (SUBPIXEL_BITS - 1))) >> SUBPIXEL_BITS;
    let side = I64Vec2::new(size.width.into(), size.height.into());
    (pixel.cmpge(I64Vec2::ZERO).all() && pixel.cmplt(side).all()).then_some((pixel.x as u32, pixel.y as u32))
}

/// The disparity at a position between four pixels of one surface.
fn interpolated(map: &DisparityMap, position: IVec2) -> Option<i32> {
    let first = position >> SUBPIXEL_BITS;
    let part = (position - (first << SUBPIXEL_BITS)).as_i64vec2();
    let around = [(0, 0), (1, 0), (0, 1), (1, 1)]
        .map(|(i, j)| i64::from(map.get_clamped((first.x + i).into(), (first.y + j).into())));
    let (least, most) = around.into_iter().fold((i64::MAX, i64::MIN), |(a, b), value| (a.min(value), b.max(value)));
    if around.contains(&NONE.into()) || most - least > SURFACE.into() {
        return None;
    }
    let ([a, b, c, d], one) = (around, 1 << SUBPIXEL_BITS);
    let rest = one - part;
    let sum = rest.y * (rest.x * a + part.x * b) + part.y * (rest.x * c + part.x * d);
    Some(((sum + one * one / 2) >> (2 * SUBPIXEL_BITS)) as i32)
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
        assert_eq!(found.confidence.data(), [0, 10, 20, 30, 40]);
    }
}
