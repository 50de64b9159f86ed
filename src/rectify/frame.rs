//! Corresponding points, and the units in which models are fitted to them.

use glam::DVec2;

use super::{
    RowModel,
    curve::{Curve, Point},
};
use crate::image::Size;

/// Largest row error of an inlier, in pixels: features are located to about half a pixel.
pub(crate) const AGREEMENT: f64 = 1.5;

/// Corresponding points of both views, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correspondence {
    /// Left point.
    pub left: DVec2,
    /// Right point.
    pub right: DVec2,
}

/// Pixels of a picture, and units of half its larger side from its centre.
pub(super) struct Frame {
    size: Size,
    centre: DVec2,
    /// Pixels per unit.
    pub unit: f64,
}

impl Frame {
    pub fn new(size: Size) -> Self {
        let centre = DVec2::new(f64::from(size.width) - 1.0, f64::from(size.height) - 1.0) / 2.0;
        Self { size, centre, unit: f64::from(size.width.max(size.height)) / 2.0 }
    }

    pub fn point(&self, point: &Correspondence) -> Point {
        let normed = |place: DVec2| (place - self.centre) / self.unit;
        Point { left: normed(point.left), right: normed(point.right) }
    }

    /// The curve without its distortion.
    pub fn model(&self, &Curve { parameters: [p2, p0, p1, p3, p4, _], .. }: &Curve) -> RowModel {
        RowModel::new(self.size, [p0, p1, self.unit * p2, p3 / self.unit, p4 / self.unit])
    }

    /// Half of width and height, in units.
    pub fn half(&self) -> DVec2 {
        self.centre / self.unit
    }
}
