//! Rendering of pictures and their ground truth.

use glam::DVec3;
use rayon::prelude::*;

use super::lighting::first;
use super::noise::normal;
use super::rig::Side;
use super::{Pair, Scene, Sensor, View};

/// Number of rays along each side of a pixel.
const RAYS: u32 = 5;
/// A point counts as seen if the other camera's ray ends this near to it, as a fraction of its depth. The tolerance is
/// far above the rounding of the intersections (1e-11) and far below any step between surfaces (0.1 mm at a metre).
const TOLERANCE: f64 = 1e-6;

/// Renders both views of `scene`.
pub fn render(scene: &Scene) -> Pair {
    let [left, right] = [Side::Left, Side::Right].map(|side| view(scene, side));
    Pair { width: scene.rig.width, height: scene.rig.height, left, right }
}

fn view(scene: &Scene, side: Side) -> View {
    let (width, height) = (scene.rig.width, scene.rig.height);
    let pixels: Vec<_> = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let (disparity, visible) = truth(scene, side, f64::from(x), f64::from(y));
            (exposed(scene, side, x, y), disparity, visible)
        })
        .collect();
    View {
        rgb: pixels.iter().flat_map(|pixel| pixel.0).collect(),
        disparity: pixels.iter().map(|pixel| pixel.1 as f32).collect(),
        visible: pixels.iter().map(|pixel| if pixel.2 { 255 } else { 0 }).collect(),
    }
}

/// The disparity at a pixel's centre, and whether the other camera sees that point in its frame.
fn truth(scene: &Scene, side: Side, x: f64, y: f64) -> (f64, bool) {
    let rig = &scene.rig;
    let Some((_, hit)) = first(&scene.objects, &rig.ray(side, x, y)) else {
        return (f64::INFINITY, false);
    };
    let disparity = rig.disparity(hit.t);
    let (other, there) = match side {
        Side::Left => (Side::Right, x - disparity),
        Side::Right => (Side::Left, x + disparity),
    };
    let inside = (0.0..=f64::from(rig.width - 1)).contains(&there);
    let seen = first(&scene.objects, &rig.ray(other, there, y)).is_some_and(|(_, h)| h.t >= hit.t * (1.0 - TOLERANCE));
    (disparity, inside && seen)
}

/// A pixel's colour: the mean of its rays, through the display's curve and the sensor.
fn exposed(scene: &Scene, side: Side, x: u32, y: u32) -> [u8; 3] {
    let samples = RAYS * RAYS;
    let light: DVec3 = (0..samples)
        .map(|i| {
            let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(RAYS) - 0.5;
            let ray = scene.rig.ray(side, f64::from(x) + offset(i % RAYS), f64::from(y) + offset(i / RAYS));
            first(&scene.objects, &ray).map_or(DVec3::ZERO, |(object, hit)| {
                let outward = object.frame.normal_to_world(hit.normal);
                // An open tube is visible from inside, too.
                let facing = if outward.dot(ray.direction) > 0.0 { -outward } else { outward };
                let colour = (object.texture)(&hit.surface).clamp(DVec3::ZERO, DVec3::ONE);
                // Textures are colours on a screen; light adds up linearly, approximated by their squares.
                colour * colour * scene.lighting.at(&scene.objects, ray.at(hit.t), facing, i, RAYS)
            })
        })
        .sum();
    let sensor = scene.sensors[usize::from(side == Side::Right)];
    let mean = light / f64::from(samples);
    std::array::from_fn(|channel| {
        let noise = sensor.noise * normal(i64::from(x), i64::from(y), channel as i64 + 1, side as u32 + 1);
        (sensor.expose(mean[channel]) + noise).round().clamp(0.0, 255.0) as u8
    })
}

impl Sensor {
    /// Converts linear light to grey levels.
    fn expose(self, light: f64) -> f64 {
        // Bright light is compressed, as on film, instead of clipped; light up to 0.7 is unchanged.
        let soft = if light > 0.7 { 0.7 + 0.3 * (light - 0.7) / (light - 0.4) } else { light };
        let shown = soft.sqrt();
        let sixteenth = shown.sqrt().sqrt().sqrt().sqrt();
        let bent = (0..self.bend).fold(shown, |value, _| value * sixteenth);
        255.0 * bent * self.gain + self.offset
    }
}
