//! Pixels of two views of any size, and the units in which geometry is computed.

use glam::{DMat3, DVec2};

use crate::{image::Size, rectify::Correspondence};

/// Largest error of an inlier, in pixels of the detection.
pub(super) const AGREEMENT: f64 = 1.5;
/// Precision of a match, in pixels of the detection: the width of the Cauchy loss.
pub(super) const PRECISION: f64 = 0.3;

/// Centres of both views, and the unit: half of the larger side of the left view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub sizes: [Size; 2],
    centres: [DVec2; 2],
    /// Pixels of the pictures per unit.
    pixels: f64,
    /// Pixels of the views in which points were detected, per unit.
    pub unit: f64,
}

impl Frame {
    /// The frame of views of `sizes`, whose points were detected after a reduction by `factor`.
    pub fn new(sizes: [Size; 2], factor: u32) -> Self {
        let centre = |size: Size| (DVec2::new(size.width.into(), size.height.into()) - 1.0) / 2.0;
        let pixels = f64::from(sizes[0].width.max(sizes[0].height)) / 2.0;
        Self { sizes, centres: sizes.map(centre), pixels, unit: pixels / f64::from(factor) }
    }

    /// A point in units from the centres of the views.
    pub fn point(&self, point: &Correspondence) -> Correspondence {
        Correspondence { left: self.place(0, point.left), right: self.place(1, point.right) }
    }

    /// A place of a view, 0 for the left one, in units from its centre.
    pub fn place(&self, view: usize, pixel: DVec2) -> DVec2 {
        (pixel - self.centres[view]) / self.pixels
    }

    /// The pixel of a place in a view.
    pub fn pixel(&self, view: usize, place: DVec2) -> DVec2 {
        place * self.pixels + self.centres[view]
    }

    /// Pixels of the pictures per pixel of the detection.
    pub fn pixels_per_detected(&self) -> f64 {
        self.pixels / self.unit
    }

    /// The map from units to pixels of a view.
    pub fn map_to_pixels(&self, view: usize) -> DMat3 {
        DMat3::from_translation(self.centres[view]) * DMat3::from_scale(DVec2::splat(self.pixels))
    }

    /// The centre of the right view from that of the left one, in units, where the top left pixels of both lie in one place.
    pub fn offset(&self) -> DVec2 {
        (self.centres[1] - self.centres[0]) / self.pixels
    }

    /// The place of the pixel in the middle of a view, right of and below the centre where that lies between pixels.
    pub fn middle(&self, view: usize) -> DVec2 {
        let Size { width, height } = self.sizes[view];
        self.place(view, DVec2::new((width / 2).into(), (height / 2).into()))
    }

    /// Half of width and height of a view between the centres of its outermost pixels, in units.
    pub fn half(&self, view: usize) -> DVec2 {
        self.centres[view] / self.pixels
    }

    /// Mean of width and height of a view, in units.
    pub fn mean_side(&self, view: usize) -> f64 {
        let Size { width, height } = self.sizes[view];
        f64::from(width + height) / 2.0 / self.pixels
    }
}

/// The place that a homography maps `place` to; `None` on the horizon and beyond.
pub(super) fn mapped(map: &DMat3, place: DVec2) -> Option<DVec2> {
    let there = *map * place.extend(1.0);
    (there.z > 0.0).then(|| there.truncate() / there.z)
}
