//! Maps of a rectified picture taken back to the view as it was taken.

use glam::DVec2;

use crate::{
    dense::Dense,
    disparity::{DisparityMap, NONE, SCALE},
    image::{Plane, Size},
    rectify::{RowModel, SUBPIXEL_BITS, WarpMap},
};

/// Largest difference of neighbouring disparities of one surface, in 1/256 px.
const SURFACE: i32 = SCALE;

/// Where each pixel of a view as it was taken appears in the rectified picture.
#[derive(Clone, Debug)]
pub struct WayBack {
    map: WarpMap,
    /// The rows of a right picture that was matched with other rows than those of the map.
    rows: Option<RowModel>,
}

impl WayBack {
    pub(super) fn new(map: WarpMap, rows: Option<RowModel>) -> Self {
        Self { map, rows }
    }

    /// Width and height of the view, in pixels.
    pub fn size(&self) -> Size {
        self.map.size()
    }

    /// The position in the rectified picture at which a pixel of the view appears, in pixels; perhaps outside the picture. `None` if
    /// it appears nowhere.
    pub fn place(&self, x: u32, y: u32) -> Option<DVec2> {
        let place = self.map.source_at(x, y)?.as_dvec2() / f64::from(1 << SUBPIXEL_BITS);
        Some(self.rows.map_or(place, |rows| place.with_y(rows.left_row(place.x, place.y))))
    }

    /// A map of the rectified picture as one of the view: disparities in pixels of the rectified pair, interpolated between
    /// neighbours within 1 px of each other and else those of the nearest pixel, and confidences of the nearest pixel.
    pub fn dense(&self, dense: &Dense) -> Dense {
        let places = Plane::from_fn(self.size(), |x, y| self.place(x, y));
        let nearest = |place: DVec2| nearest(dense.disparity.size(), place);
        Dense {
            disparity: places.map(|place| place.map_or(NONE, |place| disparity_at(&dense.disparity, place))),
            confidence: places.map(|place| place.and_then(nearest).map_or(0, |(x, y)| dense.confidence.get(x, y))),
        }
    }
}

/// The pixel of a picture nearest to a place; `None` outside the picture.
fn nearest(size: Size, place: DVec2) -> Option<(u32, u32)> {
    let pixel = place.round();
    let is_inside = pixel.cmpge(DVec2::ZERO).all() && pixel.x < size.width.into() && pixel.y < size.height.into();
    is_inside.then_some((pixel.x as u32, pixel.y as u32))
}

/// The disparity at a place between pixels.
fn disparity_at(map: &DisparityMap, place: DVec2) -> i32 {
    let Some((x, y)) = nearest(map.size(), place) else { return NONE };
    let first = place.floor();
    let around = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| map.get_clamped(first.x as i64 + i, first.y as i64 + j));
    let (least, most) = around.into_iter().fold((i32::MAX, i32::MIN), |(a, b), value| (a.min(value), b.max(value)));
    if around.contains(&NONE) || most.saturating_sub(least) > SURFACE {
        return map.get(x, y);
    }
    let [a, b, c, d] = around.map(f64::from);
    let part = place - first;
    let mix = |a: f64, b: f64, part: f64| a + part * (b - a);
    mix(mix(a, b, part.x), mix(c, d, part.x), part.y).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(values: Vec<i32>) -> Dense {
        let confidence = Plane::new((4, 1), vec![10, 20, 30, 40]).unwrap();
        Dense { disparity: Plane::new((4, 1), values).unwrap(), confidence }
    }

    /// Pixel x of the view appears at `offset + x`.
    fn way(offset: f64, rows: Option<RowModel>) -> WayBack {
        WayBack::new(WarpMap::new((5, 1), (4, 1), |p| p + DVec2::new(offset, 0.0)).unwrap(), rows)
    }

    #[test]
    fn disparities_lie_between_neighbours_of_one_surface() {
        let found = way(-0.75, None).dense(&dense(vec![100, 200, 1000, NONE]));
        // At -0.75 nothing is shown; 0.25 lies between 100 and 200, 1.25 at an edge, 2.25 beside a hole, 3.25 in it.
        assert_eq!(found.disparity.data(), [NONE, 125, 200, 1000, NONE]);
        assert_eq!(found.confidence.data(), [0, 10, 20, 30, 40]);
    }

    #[test]
    fn rows_that_were_moved_are_found_where_they_were_moved_to() {
        let up = RowModel::new((4, 1), [0.0, 1.0, -3.0, 0.0, 0.0]);
        assert_eq!(way(0.0, Some(up)).place(2, 0), Some(DVec2::new(2.0, -3.0)));
        assert_eq!(way(0.0, Some(up)).dense(&dense(vec![0; 4])).disparity.data(), [NONE; 5]);
    }
}
