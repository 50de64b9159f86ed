//! Which part of the rectified plane the pictures of a rectified pair show.

use glam::{DMat3, DVec2};

use super::{
    frame::{Frame, mapped},
    lenses::Lenses,
    shape::edge,
};
use crate::{image::Size, rectify::Correspondence};

/// Margin around the matches, as a share of their span, of views that a homography stretches beyond use elsewhere.
const MARGIN: f64 = 0.3;
/// Largest side of a rectified picture, in units of the larger side of either view.
const LARGEST: f64 = 1.5;
/// Shares of the inliers' disparities left out at either end.
const TAIL: f64 = 0.02;
/// Largest disparity of all inliers that is left as it is, as a share of the width: beyond it the pictures hardly overlap.
const FAR: f64 = 0.25;

/// A range of coordinates.
#[derive(Clone, Copy, Debug)]
struct Span {
    from: f64,
    to: f64,
}

impl Span {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        values.fold(Self { from: f64::INFINITY, to: f64::NEG_INFINITY }, |Self { from, to }, value| Self {
            from: from.min(value),
            to: to.max(value),
        })
    }

    fn length(self) -> f64 {
        self.to - self.from
    }

    fn within(self, other: Self) -> Self {
        Self { from: self.from.max(other.from), to: self.to.min(other.to) }
    }

    fn widened(self, by: f64) -> Self {
        Self { from: self.from - by, to: self.to + by }
    }
}

/// Size and places of the rectified pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub size: Size,
    /// Top left pixels of both pictures in the rectified plane, in pixels.
    pub origins: [DVec2; 2],
}

impl Layout {
    /// The left view as it was taken.
    pub fn of_left(frame: &Frame, maps: &[DMat3; 2], points: &[Correspondence]) -> Self {
        let size = frame.sizes[0];
        let shift = shift(maps, points, f64::from(size.width));
        Self { size, origins: [DVec2::ZERO, DVec2::new(-shift, 0.0)] }
    }

    /// All of the left view that the right one shows in the same rows, and what of the right view can correspond to it; around the
    /// `points` alone where the views reach further than a picture should. `maps` lead from units to pixels of the rectified plane.
    /// `None` if the views have no row in common.
    pub fn of_both(frame: &Frame, maps: &[DMat3; 2], lenses: Lenses, points: &[Correspondence]) -> Option<Self> {
        let shift = shift(maps, points, f64::from(frame.sizes[0].width));
        let places = |view: usize| {
            let right_by = DVec2::new(if view == 0 { 0.0 } else { shift }, 0.0);
            let straight = edge(frame, view)
                .map(|pixel| lenses.0[view].undistorted(frame.place(view, pixel), frame.mean_side(view)));
            let seen: Vec<_> = straight.map(|place| Some(mapped(&maps[view], place)? + right_by)).collect();
            let around: Vec<DVec2> = points
                .iter()
                .filter_map(|point| Some(mapped(&maps[view], [point.left, point.right][view])? + right_by))
                .collect();
            (seen, around)
        };
        let largest = frame.sizes.iter().map(|size| size.width.max(size.height)).max()?;
        // The span of a view along an axis.
        let span = |(seen, around): &(Vec<Option<DVec2>>, Vec<DVec2>), axis: usize| {
            let matched = Span::of(around.iter().map(|place| place[axis]));
            let matched = matched.widened(MARGIN * matched.length());
            let whole = Span::of(seen.iter().map(|place| place.map_or(f64::INFINITY, |place| place[axis])));
            let is_usable = whole.length() <= LARGEST * f64::from(largest);
            if is_usable { whole } else { Span::of(seen.iter().flatten().map(|place| place[axis])).within(matched) }
        };
        let [left, right] = [places(0), places(1)];
        let rows = span(&left, 1).within(span(&right, 1));
        let disparities = disparities(maps, points).map(|disparity| disparity - shift);
        let (left, right) = (span(&left, 0), span(&right, 0));
        // What of the right view lies left or right of all that the left view shows, and still corresponds to something.
        let corresponding = Span { from: left.from - disparities.to.max(0.0), to: left.to - disparities.from.min(0.0) };
        let right = right.within(corresponding);
        let columns = Span { from: left.from.min(right.from), to: left.to.max(right.to) };
        let origin = DVec2::new(columns.from, rows.from).ceil();
        let [width, height] = [columns.to - origin.x, rows.to - origin.y].map(|side| side.floor() + 1.0);
        let fits = |side: f64| (1.0..=4.0 * f64::from(largest)).contains(&side);
        (fits(width) && fits(height)).then(|| Self {
            size: Size::new(width as u32, height as u32),
            origins: [origin, origin - DVec2::new(shift, 0.0)],
        })
    }
}

impl Span {
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { from: f(self.from), to: f(self.to) }
    }
}

/// The span of the disparities of the points in the rectified plane, but for a few at either end.
fn disparities(maps: &[DMat3; 2], points: &[Correspondence]) -> Span {
    let column = |view: usize, place: DVec2| mapped(&maps[view], place).map(|place| place.x);
    let mut found: Vec<f64> =
        points.iter().filter_map(|point| Some(column(0, point.left)? - column(1, point.right)?)).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found.get((share * found.len().saturating_sub(1) as f64) as usize).copied().unwrap_or(0.0);
    Span { from: at(TAIL), to: at(1.0 - TAIL) }
}

/// How far the right picture is to be shifted to the right, in whole pixels: 0 unless all disparities lie far from 0.
fn shift(maps: &[DMat3; 2], points: &[Correspondence], width: f64) -> f64 {
    let found = disparities(maps, points);
    let far = FAR * width;
    if found.from > far || found.to < -far { found.from.floor() } else { 0.0 }
}
