//! Position and orientation of a shape.

use glam::{DMat3, DVec3};

use super::Ray;
use super::math::sin_cos;

/// An affine map from an object's own space to the world's.
#[derive(Clone, Copy)]
pub struct Frame {
    origin: DVec3,
    to_world: DMat3,
    to_local: DMat3,
}

impl Frame {
    /// Unturned, with the shape's origin at (x, y, z).
    pub fn at(x: f64, y: f64, z: f64) -> Self {
        Self { origin: DVec3::new(x, y, z), to_world: DMat3::IDENTITY, to_local: DMat3::IDENTITY }
    }

    fn followed_by(self, turn: DMat3) -> Self {
        let to_world = self.to_world * turn;
        Self { origin: self.origin, to_world, to_local: turn.transpose() * self.to_local }
    }

    /// Turned about its own y axis: positive angles bring the front (+z) to the right.
    pub fn yaw(self, degrees: f64) -> Self {
        let (s, c) = sin_cos(degrees);
        self.followed_by(DMat3::from_cols(DVec3::new(c, 0.0, -s), DVec3::Y, DVec3::new(s, 0.0, c)))
    }

    /// Turned about its own x axis: negative angles lean an upright front backwards, so that it faces upwards.
    pub fn pitch(self, degrees: f64) -> Self {
        let (s, c) = sin_cos(degrees);
        self.followed_by(DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c)))
    }

    /// Turned about its own z axis, anticlockwise.
    pub fn roll(self, degrees: f64) -> Self {
        let (s, c) = sin_cos(degrees);
        self.followed_by(DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z))
    }

    /// Stretched along its own axes: a sphere becomes an ellipsoid.
    pub fn scale(self, x: f64, y: f64, z: f64) -> Self {
        let by = DVec3::new(x, y, z);
        Self {
            to_world: self.to_world * DMat3::from_diagonal(by),
            to_local: DMat3::from_diagonal(by.recip()) * self.to_local,
            ..self
        }
    }

    /// The y axis runs from `a` to `b`, the origin lies half way.
    pub fn between(a: DVec3, b: DVec3) -> Self {
        let y = (b - a).normalize();
        let beside = if y.x.abs() < 0.7 { DVec3::X } else { DVec3::Z };
        let z = beside.cross(y).normalize();
        let to_world = DMat3::from_cols(y.cross(z), y, z);
        Self { origin: (a + b) * 0.5, to_world, to_local: to_world.transpose() }
    }

    /// Moved along its own axes.
    pub fn shift(self, x: f64, y: f64, z: f64) -> Self {
        Self { origin: self.origin + self.to_world * DVec3::new(x, y, z), ..self }
    }

    /// Largest factor by which the frame enlarges a length.
    pub fn stretch(&self) -> f64 {
        let DMat3 { x_axis, y_axis, z_axis } = self.to_world;
        x_axis.length().max(y_axis.length()).max(z_axis.length())
    }

    /// Position of the frame's origin in the world, in millimetres.
    pub fn position(&self) -> DVec3 {
        self.origin
    }

    /// The ray in the object's space, with the same parameter.
    pub fn ray_to_local(&self, ray: &Ray) -> Ray {
        Ray { origin: self.to_local * (ray.origin - self.origin), direction: self.to_local * ray.direction }
    }

    /// The unit normal in the world for one in the object's space.
    pub fn normal_to_world(&self, normal: DVec3) -> DVec3 {
        (self.to_local.transpose() * normal).normalize()
    }
}
