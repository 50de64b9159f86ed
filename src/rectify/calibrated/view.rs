//! One view of a rectified pair.

use glam::{DMat3, DVec2};

use crate::{
    calibration::CameraModel,
    error::Result,
    image::Size,
    rectify::map::{TOLERANCE, WarpMap},
};

/// A picture as it was taken, and as it is seen by a rectified camera.
#[derive(Clone, Debug)]
pub struct RectifiedView {
    camera: CameraModel,
    source_size: Size,
    rotation: DMat3,
    size: Size,
    focal: f64,
    centre: DVec2,
}

impl RectifiedView {
    pub(super) fn new(
        camera: CameraModel,
        source_size: Size,
        rotation: DMat3,
        size: Size,
        focal: f64,
        centre: DVec2,
    ) -> Self {
        Self { camera, source_size, rotation, size, focal, centre }
    }

    /// The camera that took the picture.
    pub fn camera(&self) -> &CameraModel {
        &self.camera
    }

    /// The rotation from the camera's coordinates to rectified ones: OpenCV's `R1` or `R2`.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// Width and height of the picture as it was taken, in pixels.
    pub fn source_size(&self) -> Size {
        self.source_size
    }

    /// Width and height of the rectified picture, in pixels.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The position in the picture as it was taken that a position of the rectified picture shows, in pixels; it can lie outside
    /// the picture. `None` where the lens is not defined.
    pub fn source_of(&self, position: DVec2) -> Option<DVec2> {
        let ray = ((position - self.centre) / self.focal).extend(1.0);
        self.camera.project(self.rotation.transpose() * ray)
    }

    /// The position in the rectified picture at which a position of the picture as it was taken appears, in pixels; it can lie
    /// outside the rectified picture. `None` for what a plane does not show, 90 degrees off the axis and beyond.
    pub fn rectified_of(&self, position: DVec2) -> Option<DVec2> {
        let ray = self.rotation * self.camera.unproject(position)?;
        let place = self.focal * ray.truncate() / ray.z + self.centre;
        (ray.z > 0.0 && place.is_finite()).then_some(place)
    }

    /// For each pixel of the rectified picture the position in the source, to within 1/32 px.
    ///
    /// # Errors
    /// As [`WarpMap::new`].
    pub fn map(&self) -> Result<WarpMap> {
        let source_of = |position: DVec2| self.source_of(position).unwrap_or(DVec2::NAN);
        WarpMap::within(TOLERANCE, self.size, self.source_size, source_of)
    }
}
