//! Light: one large lamp with soft shadows, and ambient light from the surroundings.

use glam::DVec3;

use super::frame::Frame;
use super::math::{mix, on_sphere, smoothstep};
use super::shapes::Hit;
use super::{Object, Ray};

/// Distance above a surface at which a ray starts, in millimetres, so that it does not meet the same surface again.
const CLEARANCE: f64 = 1e-4;

/// The lamp and the surroundings. Light depends on the position alone, not on the viewer, so a point has one colour in
/// both views.
pub struct Lighting {
    /// Centre of the lamp, in millimetres.
    pub lamp: DVec3,
    /// Half the side of the lamp, a square that faces the origin, in millimetres.
    pub size: f64,
    /// The lamp's colour and strength.
    pub key: DVec3,
    /// Light from above.
    pub sky: DVec3,
    /// Light from below.
    pub bounce: DVec3,
    /// Distance up to which objects darken each other (ambient occlusion), in millimetres.
    pub reach: f64,
}

/// The object that a ray meets first, and the hit.
pub fn first<'a>(objects: &'a [Object], ray: &Ray) -> Option<(&'a Object, Hit)> {
    let meetings = objects.iter().filter_map(|object| Some((object, object.meet(ray)?)));
    meetings.min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t))
}

impl Lighting {
    /// Light that reaches a point, by sample `i` of `n * n`: one position on the lamp, one direction of the
    /// surroundings. The samples of a pixel together cover the lamp and all directions.
    pub fn at(&self, objects: &[Object], point: DVec3, normal: DVec3, i: u32, n: u32) -> DVec3 {
        let start = point + normal * CLEARANCE;
        let cell = |k: u32| (f64::from(2 * k + 1) / f64::from(n) - 1.0) * self.size;
        let square = Frame::between(DVec3::ZERO, self.lamp);
        // Neighbouring samples of a pixel see different parts of the lamp: otherwise the edges of shadows would follow
        // the pixel grid.
        let spread = (i * 7) % (n * n);
        let lamp = square.shift(cell(spread % n), self.lamp.length() / 2.0, cell(spread / n)).position();
        let towards = lamp - start;
        let cosine = towards.normalize().dot(normal).max(0.0);
        let lit = cosine > 0.0
            && first(objects, &Ray { origin: start, direction: towards }).is_none_or(|(_, hit)| hit.t >= 1.0);

        let around = (normal * 1.001 + on_sphere(i, n * n)).normalize();
        let open = first(objects, &Ray { origin: start, direction: around })
            .map_or(1.0, |(_, hit)| smoothstep(0.0, self.reach, hit.t));
        let surroundings = mix(self.bounce, self.sky, around.y * 0.5 + 0.5) * mix(0.2, 1.0, open);
        surroundings + if lit { self.key * cosine } else { DVec3::ZERO }
    }
}
