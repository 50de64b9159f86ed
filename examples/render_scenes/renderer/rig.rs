//! The two cameras: one focal length, one orientation, one height.

use glam::DVec3;

use super::Ray;

/// A rectified pair of pinhole cameras.
pub struct Rig {
    /// Width of each view in pixels.
    pub width: u32,
    /// Height of each view in pixels.
    pub height: u32,
    /// Focal length in pixels.
    pub focal: f64,
    /// Distance between the cameras in millimetres.
    pub baseline: f64,
    /// Difference of the principal points, cx1 - cx0, in pixels: disparity = focal * baseline / depth - doffs.
    pub doffs: f64,
    /// The left camera's position.
    pub eye: DVec3,
    /// A point in the middle of the left view.
    pub target: DVec3,
}

/// One of the two cameras.
#[derive(Clone, Copy, PartialEq)]
pub enum Side {
    /// The left camera, at the rig's eye.
    Left,
    /// The right camera, one baseline to the right.
    Right,
}

impl Rig {
    /// Unit vectors to the right, downwards and forwards.
    fn axes(&self) -> [DVec3; 3] {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        [right, forward.cross(right), forward]
    }

    /// The principal point of a camera.
    pub fn centre(&self, side: Side) -> (f64, f64) {
        let shift = if side == Side::Right { self.doffs } else { 0.0 };
        ((f64::from(self.width) - 1.0) / 2.0 + shift, (f64::from(self.height) - 1.0) / 2.0)
    }

    /// A camera's position.
    pub fn position(&self, side: Side) -> DVec3 {
        match side {
            Side::Left => self.eye,
            Side::Right => self.eye + self.axes()[0] * self.baseline,
        }
    }

    /// The ray through a point of the picture; its parameter is the depth.
    pub fn ray(&self, side: Side, x: f64, y: f64) -> Ray {
        let [right, down, forward] = self.axes();
        let (cx, cy) = self.centre(side);
        let direction = right * ((x - cx) / self.focal) + down * ((y - cy) / self.focal) + forward;
        Ray { origin: self.position(side), direction }
    }

    /// The disparity of a point at this depth.
    pub fn disparity(&self, depth: f64) -> f64 {
        self.focal * self.baseline / depth - self.doffs
    }
}
