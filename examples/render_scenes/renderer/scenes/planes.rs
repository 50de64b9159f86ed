//! A desk against a brick wall: planes at many depths and slants, with sharp steps between them.

use glam::dvec3;

use crate::renderer::frame::Frame;
use crate::renderer::lighting::Lighting;
use crate::renderer::rig::Rig;
use crate::renderer::shapes::Cuboid;
use crate::renderer::textures::{self as look, rgb};
use crate::renderer::{Object, Scene, Sensor};

/// The scene `planes`.
pub fn scene() -> Scene {
    let paint = [rgb(0x24364f), rgb(0x3f7f8c), rgb(0xe8c27a), rgb(0xd9703f), rgb(0x7d2f3a)];
    let cloth = [rgb(0x7a1f28), rgb(0xe6dcc0), rgb(0x1f3a34), rgb(0xd9a93c)];
    let objects = vec![
        // Walls and desk.
        Object::new(
            Frame::at(0.0, 300.0, -640.0).yaw(9.0),
            Cuboid(2000.0, 1000.0, 10.0),
            look::bricks(118.0, 40.0, rgb(0xa6583f), rgb(0xb9b1a2), 11),
        ),
        Object::new(
            Frame::at(0.0, -15.0, 60.0),
            Cuboid(620.0, 15.0, 420.0),
            look::boards(84.0, rgb(0xd9ab6c), rgb(0x8a5527), 21),
        ),
        // Behind: a map, a painting, a calibration target.
        Object::new(
            Frame::at(-235.0, 122.0, -190.0).yaw(30.0).pitch(-9.0),
            Cuboid(165.0, 122.0, 3.0),
            look::map(88.0, [165.0, 122.0], "TERRA", 5),
        ),
        Object::new(
            Frame::at(60.0, 190.0, -480.0).yaw(-14.0).pitch(-5.0),
            Cuboid(150.0, 190.0, 9.0),
            look::painting([150.0, 190.0], paint, 8),
        ),
        Object::new(
            Frame::at(285.0, 112.0, -150.0).yaw(-36.0).pitch(-12.0),
            Cuboid(130.0, 112.0, 3.0),
            look::checker(26.0, 8.0, 7.0, 13),
        ),
        // Middle: three books, a page that leans on them.
        Object::new(
            Frame::at(35.0, 21.0, -30.0).yaw(8.0),
            Cuboid(118.0, 21.0, 82.0),
            look::book(rgb(0x274a6b), rgb(0xe5d5a1), "DISPARITY", 13.0, 31),
        ),
        Object::new(
            Frame::at(28.0, 60.0, -35.0).yaw(-7.0),
            Cuboid(108.0, 18.0, 76.0),
            look::book(rgb(0x8c2f2b), rgb(0xf0dfae), "OCTAVES", 15.0, 32),
        ),
        Object::new(
            Frame::at(40.0, 92.0, -42.0).yaw(15.0),
            Cuboid(96.0, 14.0, 70.0),
            look::book(rgb(0x3f6b46), rgb(0xf3e9c8), "PLANES", 13.0, 33),
        ),
        Object::new(
            Frame::at(176.0, 74.0, 90.0).yaw(-14.0).pitch(-34.0),
            Cuboid(64.0, 88.0, 1.0),
            look::page([64.0, 88.0], "STEREO", 41),
        ),
        // In front: a carton, a folded cloth, a slab of granite, a ruler's length of wood.
        Object::new(
            Frame::at(-150.0, 55.0, 75.0).yaw(38.0),
            Cuboid(62.0, 55.0, 48.0),
            look::carton("FRAGILE", 15.0, 51),
        ),
        Object::new(Frame::at(-20.0, 9.0, 240.0).yaw(-20.0), Cuboid(95.0, 9.0, 62.0), look::tartan(46.0, cloth, 61)),
        Object::new(
            Frame::at(-222.0, 44.0, 250.0).yaw(24.0).pitch(-30.0),
            Cuboid(58.0, 50.0, 8.0),
            look::granite(rgb(0x8d8a86), 71),
        ),
        Object::new(
            Frame::at(170.0, 30.0, 255.0).yaw(31.0),
            Cuboid(38.0, 30.0, 30.0),
            look::marble(rgb(0x4f7d6a), rgb(0xe4ead9), 46.0, 81),
        ),
    ];
    Scene {
        name: "planes",
        title: "A desk with books, a map and boards against a brick wall: planes only",
        rig: Rig {
            width: 340,
            height: 255,
            focal: 378.0,
            baseline: 100.0,
            doffs: 14.0,
            eye: dvec3(-20.0, 330.0, 790.0),
            target: dvec3(15.0, 92.0, -60.0),
        },
        lighting: Lighting {
            lamp: dvec3(-700.0, 1250.0, 900.0),
            size: 130.0,
            key: dvec3(1.0, 0.95, 0.86) * 0.80,
            sky: dvec3(0.46, 0.50, 0.56),
            bounce: dvec3(0.24, 0.20, 0.16),
            reach: 260.0,
        },
        sensors: [Sensor::PERFECT; 2],
        objects,
    }
}
