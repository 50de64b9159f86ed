//! A still life on rumpled cloth: balls, tins, a vase with a plant, pencils and a wire grid, with many occlusions.

use glam::{DVec3, dvec3};

use crate::renderer::frame::Frame;
use crate::renderer::lighting::Lighting;
use crate::renderer::math::{smoothstep, wave};
use crate::renderer::noise::uniform;
use crate::renderer::rig::Rig;
use crate::renderer::shapes::{Cuboid, Cylinder, Ground, Implicit, Sphere};
use crate::renderer::textures::{self as look, rgb};
use crate::renderer::{Object, Scene, Sensor};

/// The scene `curved`.
pub fn scene() -> Scene {
    let cloth = [rgb(0x2f4f74), rgb(0xe9e2cf), rgb(0x7f9bb3), rgb(0xb5483b)];
    let mut objects = vec![
        Object::new(
            Frame::at(0.0, 0.0, 0.0).yaw(24.0),
            Ground { rise: 21.0, height: folds },
            look::tartan(82.0, cloth, 3),
        ),
        Object::new(
            Frame::at(0.0, 300.0, -560.0).yaw(-6.0).roll(90.0),
            Cuboid(1000.0, 2000.0, 10.0),
            look::boards(105.0, rgb(0x9fb8a8), rgb(0x55776c), 4),
        ),
        Object::new(Frame::at(-190.0, 92.0, -110.0).roll(-23.0), Sphere(92.0), look::globe(60.0, 16)),
        Object::new(
            Frame::at(-92.0, 42.0, 160.0).yaw(35.0),
            Sphere(42.0),
            look::turned(rgb(0xe0b377), rgb(0x8d5527), 6),
        ),
        Object::new(Frame::at(20.0, 24.0, 235.0), Sphere(27.0), look::marble(rgb(0x7d2233), rgb(0xf1d9c8), 26.0, 7)),
        Object::new(
            Frame::at(196.0, 62.0, 120.0).yaw(-12.0),
            Cylinder::solid(44.0, 62.0),
            look::tin(62.0, "TOMATO", [rgb(0xb7281f), rgb(0xf2e6c4), rgb(0xf3c14b)], 9),
        ),
        Object::new(
            Frame::at(-262.0, 58.0, 120.0).yaw(60.0).roll(84.0),
            Cylinder::solid(38.0, 58.0),
            look::granite(rgb(0xa08f7a), 10),
        ),
        Object::new(
            Frame::at(30.0, 100.0, -90.0),
            Implicit { reach: 125.0, step: 2.0, field: |p: DVec3| (p.x * p.x + p.z * p.z).sqrt() - vase_radius(p.y) },
            look::glazed(rgb(0xb8734a), rgb(0x2c6a80), rgb(0xf1e4c4), 12),
        ),
        Object::new(
            Frame::at(290.0, 190.0, -330.0),
            Cylinder::solid(62.0, 210.0),
            look::marble(rgb(0xcfc8ba), rgb(0x6d6358), 90.0, 14),
        ),
    ];
    objects.extend(plant(dvec3(30.0, 195.0, -90.0)));
    objects.extend(pencils(dvec3(118.0, 45.0, 30.0)));
    objects.extend(grid(dvec3(-70.0, 0.0, -330.0)));
    Scene {
        name: "curved",
        title: "A still life on rumpled cloth: curved surfaces, occlusions and thin structures",
        rig: Rig {
            width: 340,
            height: 255,
            focal: 388.0,
            baseline: 95.0,
            doffs: 11.0,
            eye: dvec3(-35.0, 300.0, 790.0),
            target: dvec3(0.0, 105.0, -60.0),
        },
        lighting: Lighting {
            lamp: dvec3(620.0, 1250.0, 850.0),
            size: 140.0,
            key: dvec3(1.0, 0.94, 0.84) * 0.80,
            sky: dvec3(0.46, 0.51, 0.57),
            bounce: dvec3(0.22, 0.21, 0.20),
            reach: 220.0,
        },
        sensors: [Sensor::PERFECT; 2],
        objects,
    }
}

/// The cloth's height: three crossing waves.
fn folds(x: f64, z: f64) -> f64 {
    9.0 * wave(x / 260.0 + 0.15 * wave(z / 340.0))
        + 7.0 * wave(z / 190.0 + x / 520.0 + 0.3)
        + 3.0 * wave((x - z) / 97.0 + 0.12 * wave(x / 130.0))
}

/// A vase's radius at a height above its middle: foot, belly, neck, lip.
fn vase_radius(y: f64) -> f64 {
    if y.abs() > 98.0 {
        return -1.0;
    }
    let belly = 1.0 - ((y + 22.0) / 92.0) * ((y + 22.0) / 92.0);
    30.0 + 36.0 * belly.max(0.0) + 16.0 * smoothstep(70.0, 98.0, y) - 6.0 * smoothstep(20.0, 70.0, y)
}

/// Stems that rise from `foot`, each with leaves on both sides.
fn plant(foot: DVec3) -> Vec<Object> {
    let mut objects = Vec::new();
    for stem in 0..6_i64 {
        let r = |k: i64| uniform(stem, k, 0, 77) - 0.5;
        let lean = dvec3(-125.0 + 50.0 * stem as f64 + 30.0 * r(0), 135.0 + 50.0 * r(1), 110.0 * r(2));
        let tip = foot + lean;
        objects.push(Object::new(
            Frame::between(foot, tip),
            Cylinder::solid(2.2, lean.length() / 2.0),
            look::painted(rgb(0x5c7a34), 40 + stem as u32),
        ));
        for k in 0..5_i64 {
            let q = |i: i64| uniform(stem, k, i, 78) - 0.5;
            let at = foot + lean * (0.42 + 0.14 * k as f64);
            let side = if k % 2 == 0 { 1.0 } else { -1.0 };
            let out = dvec3(side * (38.0 + 16.0 * q(0)), 22.0 + 34.0 * q(1), 50.0 * q(2));
            let frame = Frame::between(at, at + out).yaw(150.0 * q(3)).scale(13.0, out.length() / 2.0, 1.6);
            let tint = mix_green(q(4) + 0.5);
            objects.push(Object::new(frame, Sphere(1.0), look::leaf(tint, (stem * 8 + k) as u32)));
        }
    }
    objects
}

fn mix_green(t: f64) -> DVec3 {
    rgb(0x3f6f2a) * (1.0 - t) + rgb(0x8db04b) * t
}

/// Pencils in an open cup that stands on the ground below `middle`.
fn pencils(middle: DVec3) -> Vec<Object> {
    let cup = Cylinder { radius: 31.0, half: 44.0, closed: false };
    let clay = look::glazed(rgb(0xd9cdb4), rgb(0xd8b65a), rgb(0x394a63), 19);
    let mut objects = vec![Object::new(Frame::at(middle.x, middle.y, middle.z), cup, clay)];
    let paints = [0xd7402f, 0xf0b92f, 0x2d6fa8, 0x3c8f54, 0xe7e2d5, 0x6d3f86, 0xe07a2c];
    for (i, paint) in paints.into_iter().enumerate() {
        let r = |k: i64| uniform(i as i64, k, 0, 91) - 0.5;
        let a = middle + dvec3(30.0 * r(0), -40.0, 30.0 * r(1));
        let b = middle + dvec3(-27.0 + 9.0 * i as f64, 44.0, 34.0 * r(2));
        let axis = (b - a).normalize();
        let end = a + axis * (150.0 + 50.0 * r(3));
        objects.push(Object::new(
            Frame::between(a, end),
            Cylinder::solid(3.4, (end - a).length() / 2.0),
            look::painted(rgb(paint), 95 + i as u32),
        ));
        objects.push(Object::new(
            Frame::between(end, end + axis * 9.0),
            Cylinder::solid(1.6, 4.5),
            look::painted(rgb(0xd9b98a), 96),
        ));
    }
    objects
}

/// A grid of wires that stands upright, its lower left corner at `corner`.
fn grid(corner: DVec3) -> Vec<Object> {
    let frame = Frame::at(corner.x, corner.y, corner.z).yaw(-16.0);
    let wire = |x0: f64, y0: f64, x1: f64, y1: f64, radius: f64| {
        let (a, b) = (frame.shift(x0, y0, 0.0).position(), frame.shift(x1, y1, 0.0).position());
        let black = look::painted(rgb(0x33363a), 23);
        Object::new(Frame::between(a, b), Cylinder::solid(radius, (b - a).length() / 2.0), black)
    };
    let upright = (0..=10).map(|i| f64::from(i) * 34.0).map(|x| wire(x, -10.0, x, 330.0, 2.6));
    let across = (1..=9).map(|i| f64::from(i) * 36.0).map(|y| wire(0.0, y, 340.0, y, 2.6));
    upright.chain(across).collect()
}
