//! Textures of surfaces: colours on a screen (0 to 1) by position in millimetres.

mod made;
mod natural;
mod printed;

use glam::{DVec3, dvec3};

use super::Surface;
use super::noise::{fractal, gradient};

pub use made::{checker, glazed, painting, tartan};
pub use natural::{boards, bricks, granite, leaf, marble, turned};
pub use printed::{book, carton, globe, map, page, tin};

/// The colour of each point of a surface.
pub type Texture = Box<dyn Fn(&Surface) -> DVec3 + Send + Sync>;

/// A colour as it is written in a style sheet: 0xrrggbb.
pub const fn rgb(hex: u32) -> DVec3 {
    dvec3(((hex >> 16) & 255) as f64 / 255.0, ((hex >> 8) & 255) as f64 / 255.0, (hex & 255) as f64 / 255.0)
}

fn flat(u: f64, v: f64) -> DVec3 {
    dvec3(u, v, 0.5)
}

/// Dust, wear and stains: a factor about 1.
fn wear(p: DVec3, seed: u32) -> f64 {
    1.0 + 0.10 * fractal(p / 45.0, 3, seed) + 0.07 * fractal(p / 5.0, 2, seed + 1)
}

/// One colour, a little worn.
pub fn painted(colour: DVec3, seed: u32) -> Texture {
    Box::new(move |s| colour * wear(s.point, seed))
}

/// One colour with hardly any texture: `contrast` is the share of the grain.
pub fn smooth(colour: DVec3, contrast: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        colour * (1.0 + contrast * (fractal(s.point / 60.0, 3, seed) + 0.6 * gradient(s.point / 6.0, seed)))
    })
}
