//! A small ray tracer for rectified stereo pairs whose disparities are known exactly.
//!
//! Results are the same bytes on every machine: hashes are integer arithmetic, and floats are `f64` under `+ - * /` and
//! `sqrt` only, which IEEE 754 rounds correctly everywhere and Rust neither fuses nor reorders. Sine, cosine and arc
//! tangent are polynomials in [`math`]; nothing calls the platform's mathematical library.
//!
//! World: millimetres, x right, y up, z towards the viewer.

mod files;
mod font;
mod frame;
mod lighting;
mod math;
mod noise;
mod rig;
mod scenes;
mod shapes;
mod textures;
mod trace;

pub use files::write;
pub use scenes::scenes;
pub use trace::render;

use frame::Frame;
use glam::DVec3;
use lighting::Lighting;
use rig::Rig;
use shapes::{Hit, Shape};
use textures::Texture;

/// A shape with its position and texture.
pub struct Object {
    frame: Frame,
    shape: Box<dyn Shape>,
    texture: Texture,
    /// Radius of a bounding sphere about its position, in millimetres, a little too large.
    reach: f64,
}

impl Object {
    fn new(frame: Frame, shape: impl Shape + 'static, texture: Texture) -> Self {
        let reach = shape.reach() * frame.stretch() * 1.001;
        Self { frame, shape: Box::new(shape), texture, reach }
    }

    /// The first hit of a ray with the object.
    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let from = ray.origin - self.frame.position();
        let (outside, along) = (from.dot(from) - self.reach * self.reach, from.dot(ray.direction));
        let passes = along > 0.0 || along * along < outside * ray.direction.dot(ray.direction);
        if outside > 0.0 && passes {
            return None;
        }
        self.shape.meet(&self.frame.ray_to_local(ray))
    }
}

/// The response of a camera's sensor, in grey levels after the display's curve.
#[derive(Clone, Copy)]
pub struct Sensor {
    gain: f64,
    offset: f64,
    /// The exponent of the response is `1 + bend / 16`.
    bend: u32,
    /// Standard deviation of the noise, in grey levels.
    noise: f64,
}

impl Sensor {
    /// A sensor that changes nothing.
    const PERFECT: Self = Self { gain: 1.0, offset: 0.0, bend: 0, noise: 0.0 };
}

/// A scene to render.
pub struct Scene {
    /// Name of the scene and of its folder.
    pub name: &'static str,
    title: &'static str,
    rig: Rig,
    lighting: Lighting,
    sensors: [Sensor; 2],
    objects: Vec<Object>,
}

/// A camera's picture with its ground truth, in row-major order from the top left.
pub struct View {
    /// Red, green and blue, 8 bits each.
    pub rgb: Vec<u8>,
    /// True disparity at each pixel's centre, in pixels.
    pub disparity: Vec<f32>,
    /// 255 where the other camera sees the same point, else 0.
    pub visible: Vec<u8>,
}

/// Both views of a scene.
pub struct Pair {
    /// Width of both views, in pixels.
    pub width: u32,
    /// Height of both views, in pixels.
    pub height: u32,
    /// The left view.
    pub left: View,
    /// The right view.
    pub right: View,
}

/// A half line; `direction` need not have unit length.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

impl Ray {
    fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A point of a surface, in its object's frame.
#[derive(Clone, Copy)]
struct Surface {
    point: DVec3,
    /// Position along the surface from the middle of the face, in millimetres, v upwards for a viewer outside.
    uv: [f64; 2],
    /// Index of the face of a [`shapes::Cuboid`] (0 to 5: +x -x +y -y +z -z) or of the end of a [`shapes::Cylinder`]
    /// (1, 2).
    face: usize,
}
