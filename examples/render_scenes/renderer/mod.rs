//! A small ray tracer for rectified stereo pairs whose disparities are known exactly.
//!
//! The same bytes on every machine: hashes are integer arithmetic, and floats are `f64` under `+ - * /` and `sqrt`
//! only, which IEEE 754 rounds correctly everywhere and Rust neither fuses nor reorders. Sine, cosine and arc tangent
//! are polynomials in [`math`]; nothing calls the platform's mathematical library.
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

/// One shape, where it stands, and what it looks like.
pub struct Object {
    frame: Frame,
    shape: Box<dyn Shape>,
    texture: Texture,
    /// The radius of a sphere about its place that holds all of it, a little too large.
    reach: f64,
}

impl Object {
    fn new(frame: Frame, shape: impl Shape + 'static, texture: Texture) -> Self {
        let reach = shape.reach() * frame.stretch() * 1.001;
        Self { frame, shape: Box::new(shape), texture, reach }
    }

    /// Where a ray meets it first.
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

/// What a camera makes of the light that reaches it, in grey levels after the display's curve.
#[derive(Clone, Copy)]
pub struct Sensor {
    gain: f64,
    offset: f64,
    /// The exponent of the response is `1 + bend / 16`.
    bend: u32,
    /// Standard deviation of the noise.
    noise: f64,
}

impl Sensor {
    /// Passes everything on unchanged.
    const PERFECT: Self = Self { gain: 1.0, offset: 0.0, bend: 0, noise: 0.0 };
}

/// What there is to render.
pub struct Scene {
    /// The folder's name.
    pub name: &'static str,
    title: &'static str,
    rig: Rig,
    lighting: Lighting,
    sensors: [Sensor; 2],
    objects: Vec<Object>,
}

/// A camera's picture with its truth, in row-major order from the top left.
pub struct View {
    /// Red, green, blue.
    pub rgb: Vec<u8>,
    /// Disparity in pixels at each pixel's centre.
    pub disparity: Vec<f32>,
    /// 255 where the other camera sees the same point, else 0.
    pub visible: Vec<u8>,
}

/// Both views of a scene.
pub struct Pair {
    /// Width of each view.
    pub width: u32,
    /// Height of each view.
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
    /// Millimetres along the surface from the middle of the face, v upwards as a viewer outside reads it.
    uv: [f64; 2],
    /// Which face of a [`shapes::Cuboid`] (0 to 5: +x -x +y -y +z -z), which end of a [`shapes::Cylinder`] (1, 2).
    face: usize,
}
