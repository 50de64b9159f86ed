//! Shapes in their own space, and their intersection with rays.

use glam::DVec3;

use super::math::{angle, arc};
use super::{Ray, Surface};

/// A hit of a ray with a surface.
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    /// Outward normal, of any length.
    pub normal: DVec3,
    /// The point of the surface.
    pub surface: Surface,
}

/// A shape that rays can meet.
pub trait Shape: Send + Sync {
    /// The first hit with `t > 0`.
    fn meet(&self, ray: &Ray) -> Option<Hit>;

    /// Radius of a bounding sphere about the origin.
    fn reach(&self) -> f64;
}

/// A box, given by half its sides.
pub struct Cuboid(pub f64, pub f64, pub f64);

impl Shape for Cuboid {
    fn reach(&self) -> f64 {
        DVec3::new(self.0, self.1, self.2).length()
    }

    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let half = [self.0, self.1, self.2];
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let (mut near, mut far) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for axis in 0..3 {
            if direction[axis] == 0.0 {
                if origin[axis].abs() > half[axis] {
                    return None;
                }
                continue;
            }
            let a = (-half[axis] - origin[axis]) / direction[axis];
            let b = (half[axis] - origin[axis]) / direction[axis];
            if a.min(b) > near.0 {
                near = (a.min(b), axis);
            }
            if a.max(b) < far.0 {
                far = (a.max(b), axis);
            }
        }
        let (t, axis) = if near.0 > 0.0 { near } else { far };
        if near.0 > far.0 || t <= 0.0 {
            return None;
        }
        let point = ray.at(t);
        let positive = point.to_array()[axis] > 0.0;
        let mut normal = [0.0; 3];
        normal[axis] = if positive { 1.0 } else { -1.0 };
        let uv = match (axis, positive) {
            (0, true) => [-point.z, point.y],
            (0, false) => [point.z, point.y],
            (1, true) => [point.x, -point.z],
            (1, false) => [point.x, point.z],
            (_, true) => [point.x, point.y],
            (_, false) => [-point.x, point.y],
        };
        let surface = Surface { point, uv, face: axis * 2 + usize::from(!positive) };
        Some(Hit { t, normal: normal.into(), surface })
    }
}

/// The two roots of `a t^2 + 2 b t + c`, the smaller first.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || a == 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    Some([(-b - root) / a, (-b + root) / a])
}

/// A ball, given by its radius.
pub struct Sphere(pub f64);

impl Shape for Sphere {
    fn reach(&self) -> f64 {
        self.0
    }

    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let (o, d) = (ray.origin, ray.direction);
        let [near, far] = roots(d.dot(d), o.dot(d), o.dot(o) - self.0 * self.0)?;
        let t = if near > 0.0 { near } else { far };
        let point = ray.at(t);
        let waist = (point.x * point.x + point.z * point.z).sqrt();
        let uv = [arc(point.x, point.z, self.0), arc(point.y, waist, self.0)];
        (t > 0.0).then_some(Hit { t, normal: point, surface: Surface { point, uv, face: 0 } })
    }
}

/// A cylinder about the y axis.
pub struct Cylinder {
    /// Radius of the cylinder.
    pub radius: f64,
    /// Half the height of the cylinder.
    pub half: f64,
    /// Whether the cylinder is closed at both ends; otherwise it is an open tube.
    pub closed: bool,
}

impl Cylinder {
    /// A closed cylinder.
    pub fn solid(radius: f64, half: f64) -> Self {
        Self { radius, half, closed: true }
    }
}

impl Shape for Cylinder {
    fn reach(&self) -> f64 {
        (self.radius * self.radius + self.half * self.half).sqrt()
    }

    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let (o, d) = (ray.origin, ray.direction);
        let (a, b) = (d.x * d.x + d.z * d.z, o.x * d.x + o.z * d.z);
        let wall = roots(a, b, o.x * o.x + o.z * o.z - self.radius * self.radius);
        let side = wall.into_iter().flatten().find(|&t| t > 0.0 && ray.at(t).y.abs() <= self.half).map(|t| {
            let point = ray.at(t);
            let uv = [arc(point.x, point.z, self.radius), point.y];
            Hit { t, normal: DVec3::new(point.x, 0.0, point.z), surface: Surface { point, uv, face: 0 } }
        });
        let end = [1.0, -1.0].iter().filter(|_| self.closed && d.y != 0.0).filter_map(|&sign| {
            let t = (sign * self.half - o.y) / d.y;
            let point = ray.at(t);
            let inside = point.x * point.x + point.z * point.z <= self.radius * self.radius;
            let surface = Surface { point, uv: [point.x, -sign * point.z], face: if sign > 0.0 { 1 } else { 2 } };
            (t > 0.0 && inside).then_some(Hit { t, normal: DVec3::Y * sign, surface })
        });
        side.into_iter().chain(end).min_by(|a, b| a.t.total_cmp(&b.t))
    }
}

/// The ray's first change of sign of `field` between two parameters, seen in steps of `step` mm and then narrowed to
/// the last bits by false position (with the Illinois rule: Dowell and Jarratt, BIT 11, 1971).
fn crossing(field: impl Fn(DVec3) -> f64, ray: &Ray, from: f64, to: f64, step: f64) -> Option<f64> {
    let steps = ((to - from) * ray.direction.length() / step).clamp(1.0, 200.0).ceil();
    let at = |i: f64| from + (to - from) * (i / steps);
    let start = field(ray.at(from));
    let (mut low, mut below) = (from, start);
    let mut i = 1.0;
    let (mut high, mut above) = loop {
        let (t, value) = (at(i), field(ray.at(at(i))));
        if (value > 0.0) != (start > 0.0) {
            break (t, value);
        }
        if i >= steps {
            return None;
        }
        (low, below) = (t, value);
        i += 1.0;
    };
    let (mut t, mut kept) = (low, 0);
    for _ in 0..60 {
        t = (low * above - high * below) / (above - below);
        let value = field(ray.at(t));
        if value.abs() < 1e-10 {
            break;
        }
        if (value > 0.0) == (start > 0.0) {
            (low, below) = (t, value);
            above *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            (high, above) = (t, value);
            below *= if kept == 2 { 0.5 } else { 1.0 };
            kept = 2;
        }
    }
    Some(t)
}

/// The gradient of `field` by central differences.
fn slope(field: impl Fn(DVec3) -> f64, p: DVec3) -> DVec3 {
    const STEP: f64 = 1e-3;
    let along = |axis: DVec3| field(p + axis * STEP) - field(p - axis * STEP);
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// The surface on which `field` is 0, inside a sphere of radius `reach` about the origin; positive outside.
pub struct Implicit<F> {
    /// Radius of a bounding sphere.
    pub reach: f64,
    /// Step of the search along a ray, in millimetres; thinner parts can be missed.
    pub step: f64,
    /// The field, positive outside, negative inside.
    pub field: F,
}

impl<F: Fn(DVec3) -> f64 + Send + Sync> Shape for Implicit<F> {
    fn reach(&self) -> f64 {
        self.reach
    }

    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let (o, d) = (ray.origin, ray.direction);
        let [near, far] = roots(d.dot(d), o.dot(d), o.dot(o) - self.reach * self.reach)?;
        if far <= 0.0 {
            return None;
        }
        let t = crossing(&self.field, ray, near.max(0.0), far, self.step)?;
        let point = ray.at(t);
        let around = angle(point.x, point.z) * self.reach;
        Some(Hit { t, normal: slope(&self.field, point), surface: Surface { point, uv: [around, point.y], face: 0 } })
    }
}

/// An infinite ground `y = height(x, z)`, between -`rise` and `rise`.
pub struct Ground<F> {
    /// The greatest height and depth.
    pub rise: f64,
    /// The height above (x, z).
    pub height: F,
}

impl<F: Fn(f64, f64) -> f64 + Send + Sync> Shape for Ground<F> {
    fn reach(&self) -> f64 {
        f64::INFINITY
    }

    fn meet(&self, ray: &Ray) -> Option<Hit> {
        let (o, d) = (ray.origin, ray.direction);
        if d.y == 0.0 {
            return None;
        }
        let (top, bottom) = ((self.rise - o.y) / d.y, (-self.rise - o.y) / d.y);
        let (near, far) = (top.min(bottom).max(0.0), top.max(bottom));
        let field = |p: DVec3| p.y - (self.height)(p.x, p.z);
        if far <= near {
            return None;
        }
        let t = crossing(field, ray, near, far, 12.0)?;
        let point = ray.at(t);
        Some(Hit { t, normal: slope(field, point), surface: Surface { point, uv: [point.x, -point.z], face: 0 } })
    }
}
