//! Maps of a rectified picture taken back to the view as it was taken.

use glam::DVec2;

use crate::{
    cpu,
    dense::Dense,
    image::Size,
    rectify::{SUBPIXEL_BITS, WarpMap},
};

/// Where each pixel of a view as it was taken appears in the rectified picture.
#[derive(Clone, Debug)]
pub struct WayBack {
    map: WarpMap,
}

impl WayBack {
    pub(super) fn new(map: WarpMap) -> Self {
        Self { map }
    }

    /// The map from pixels of the view to the rectified picture: see [`crate::Matcher::outputs_back`].
    pub fn map(&self) -> &WarpMap {
        &self.map
    }

    /// Width and height of the view, in pixels.
    pub fn size(&self) -> Size {
        self.map.size()
    }

    /// The position in the rectified picture at which a pixel of the view appears, in pixels; perhaps outside the picture. `None` if
    /// it appears nowhere.
    pub fn place(&self, x: u32, y: u32) -> Option<DVec2> {
        Some(self.map.source_at(x, y)?.as_dvec2() / f64::from(1 << SUBPIXEL_BITS))
    }

    /// A map of the rectified picture as one of the view: disparities in pixels of the rectified pair, and confidences.
    ///
    /// Of the four pixels around the place at which a pixel appears, those of one surface, within 1 px of each other, that are closest
    /// together make its disparity, in proportion to how close each is; the closest of them has its confidence. So a pixel beside an
    /// edge of the rectified picture, and of a hole, belongs to the surface that ends there.
    pub fn dense(&self, dense: &Dense) -> Dense {
        cpu::dense::map_back(dense, &self.map)
    }
}
