//! Pale objects in front of a seamless backdrop: little texture, smooth shading, and a right camera with another
//! exposure, response and noise.

use glam::{DVec3, dvec3};

use crate::renderer::frame::Frame;
use crate::renderer::lighting::Lighting;
use crate::renderer::math::smoothstep;
use crate::renderer::rig::Rig;
use crate::renderer::shapes::{Cuboid, Cylinder, Implicit, Sphere};
use crate::renderer::textures::{self as look, rgb};
use crate::renderer::{Object, Scene, Sensor};

/// The scene `weak`.
pub fn scene() -> Scene {
    let pale = |hex: u32, seed: u32| look::smooth(rgb(hex), 0.05, seed);
    let objects = vec![
        Object::new(
            Frame::at(0.0, 0.0, -200.0),
            Implicit { reach: 2400.0, step: 25.0, field: backdrop },
            pale(0xcfcac0, 1),
        ),
        Object::new(Frame::at(-150.0, 92.0, -60.0), Sphere(92.0), pale(0xd8d4cb, 2)),
        Object::new(
            Frame::at(45.0, 105.0, -110.0),
            Implicit { reach: 128.0, step: 2.0, field: |p: DVec3| (p.x * p.x + p.z * p.z).sqrt() - bottle_radius(p.y) },
            pale(0xb9c2c4, 3),
        ),
        Object::new(Frame::at(205.0, 70.0, -40.0).yaw(-33.0), Cuboid(62.0, 70.0, 50.0), pale(0xc9bfae, 4)),
        Object::new(Frame::at(205.0, 172.0, -40.0), Sphere(32.0), pale(0xbf8f7a, 5)),
        Object::new(Frame::at(-45.0, 27.0, 150.0).yaw(25.0).scale(36.0, 27.0, 27.0), Sphere(1.0), pale(0xe2d6c2, 6)),
        Object::new(Frame::at(30.0, 25.0, 185.0).yaw(-40.0).scale(34.0, 25.0, 25.0), Sphere(1.0), pale(0xd2b59a, 7)),
        Object::new(Frame::at(-215.0, 60.0, 130.0), Cylinder::solid(30.0, 60.0), pale(0xd9cfb6, 8)),
        Object::new(
            Frame::at(150.0, 14.0, 150.0).yaw(24.0),
            Cuboid(66.0, 14.0, 46.0),
            look::book(rgb(0x8a97a0), rgb(0xe4ddcb), "QUIET", 14.0, 9),
        ),
    ];
    Scene {
        name: "weak",
        title: "Pale things before a seamless backdrop: weak texture, another exposure and noise in the right view",
        rig: Rig {
            width: 287,
            height: 215,
            focal: 323.0,
            baseline: 98.0,
            doffs: 8.0,
            eye: dvec3(-30.0, 270.0, 760.0),
            target: dvec3(0.0, 85.0, -40.0),
        },
        lighting: Lighting {
            lamp: dvec3(-900.0, 1000.0, 600.0),
            size: 160.0,
            key: dvec3(1.0, 0.97, 0.92) * 0.62,
            sky: dvec3(0.36, 0.38, 0.42),
            bounce: dvec3(0.22, 0.21, 0.20),
            reach: 240.0,
        },
        sensors: [
            Sensor { gain: 1.0, offset: 0.0, bend: 0, noise: 0.7 },
            Sensor { gain: 0.86, offset: 9.0, bend: 1, noise: 1.0 },
        ],
        objects,
    }
}

/// Ground and wall that meet in a hollow of radius 260 mm.
fn backdrop(p: DVec3) -> f64 {
    const HOLLOW: f64 = 260.0;
    let (y, z) = (p.y - HOLLOW, p.z - HOLLOW + 250.0);
    if y < 0.0 && z < 0.0 { HOLLOW - (y * y + z * z).sqrt() } else { p.y.min(z + HOLLOW) }
}

/// A bottle's radius at a height above its middle.
fn bottle_radius(y: f64) -> f64 {
    if y.abs() > 105.0 {
        return -1.0;
    }
    56.0 - 34.0 * smoothstep(5.0, 62.0, y) + 5.0 * smoothstep(92.0, 100.0, y) - 6.0 * smoothstep(-85.0, -105.0, y)
}
