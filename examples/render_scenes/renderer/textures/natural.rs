//! Wood, stone, clay, leaves.

use glam::{DVec3, dvec3};

use super::{Texture, flat, wear};
use crate::renderer::math::{mix, smoothstep};
use crate::renderer::noise::{fractal, gradient, hash, uniform};

/// Grain of wood along u at a place of a board.
pub fn grain(u: f64, v: f64, seed: u32, light: DVec3, dark: DVec3) -> DVec3 {
    let bend = 9.0 * fractal(dvec3(u / 190.0, v / 42.0, 0.5), 3, seed);
    let ring = v / 6.5 + bend;
    let late = smoothstep(0.15, 0.95, ring - ring.floor());
    let fibre = fractal(dvec3(u / 38.0, v / 1.9, 3.5), 2, seed + 7);
    let pore = smoothstep(0.35, 0.6, gradient(dvec3(u / 22.0, v / 1.6, 9.5), seed + 9));
    mix(light, dark, (0.65 * late * late + 0.22 * fibre + 0.35 * pore + 0.1).clamp(0.0, 1.0))
}

/// Boards along u, `width` wide, with dark joints between them.
pub fn boards(width: f64, light: DVec3, dark: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let board = (v / width).floor();
        let id = board as i64;
        let u = u + 900.0 * uniform(id, 0, 0, seed);
        let length = 7.0 * width;
        let piece = (u / length).floor();
        let key = seed.wrapping_add(hash(id, piece as i64, 1, seed) >> 4);
        let tint = 0.80 + 0.28 * uniform(id, piece as i64, 2, seed);
        let edge = (v - board * width).min((board + 1.0) * width - v).min(u - piece * length);
        grain(u, v, key, light, dark) * tint * smoothstep(-0.4, 1.8, edge).max(0.25) * wear(flat(u, v), seed)
    })
}

/// Solid wood with the rings of a trunk along the x axis: turned balls.
pub fn turned(light: DVec3, dark: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        let p = s.point + dvec3(0.0, 35.0, 60.0);
        let radius = (p.y * p.y + p.z * p.z).sqrt() + 5.0 * fractal(s.point / 40.0, 2, seed);
        grain(p.x, radius, seed, light, dark)
    })
}

/// A wall of bricks in running bond.
pub fn bricks(width: f64, height: f64, colour: DVec3, joint: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let ragged = 2.2 * fractal(flat(u / 16.0, v / 16.0), 2, seed);
        let course = (v / height).floor();
        let along = u / width + if course.rem_euclid(2.0) == 0.0 { 0.0 } else { 0.5 };
        let id = (along.floor() as i64, course as i64);
        let du = (along - along.floor()).min(along.ceil() - along) * width;
        let dv = (v - course * height).min((course + 1.0) * height - v);
        let inside = smoothstep(2.5, 5.5, du.min(dv) + ragged);
        let tone = uniform(id.0, id.1, 0, seed);
        let burnt = mix(colour, dvec3(0.30, 0.20, 0.19), 0.75 * tone * tone);
        let brick = burnt * (0.78 + 0.35 * uniform(id.0, id.1, 1, seed));
        let spots = 1.0 + 0.30 * fractal(flat(u / 9.0, v / 9.0), 4, seed + 3);
        let sand = 1.0 + 0.22 * fractal(flat(u / 5.0, v / 5.0), 3, seed + 4);
        // The joint lies deeper, so the course above shades its upper edge.
        let shade = if inside < 0.5 && v - course * height > height / 2.0 { 0.72 } else { 1.0 };
        mix(joint * sand * shade, brick * spots, inside)
    })
}

/// Speckled stone.
pub fn granite(colour: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        let cloud = fractal(s.point / 35.0, 4, seed);
        let mica = smoothstep(0.28, 0.5, gradient(s.point / 4.2, seed + 5));
        let quartz = smoothstep(0.25, 0.5, gradient(s.point / 6.1, seed + 6));
        mix(
            mix(colour * (1.0 + 0.3 * cloud), dvec3(0.93, 0.90, 0.86), 0.6 * quartz),
            dvec3(0.10, 0.10, 0.12),
            0.8 * mica,
        )
    })
}

/// Polished stone with veins.
pub fn marble(colour: DVec3, vein: DVec3, size: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        let p = s.point / size;
        let warp = dvec3(fractal(p, 3, seed), fractal(p, 3, seed + 20), fractal(p, 3, seed + 40));
        let ridge =
            |scale: f64, k: u32| 1.0 - smoothstep(0.0, 0.16, gradient((p + warp * 0.9) * scale, seed + k).abs());
        let veins = (0.9 * ridge(0.8, 60) + 0.5 * ridge(2.1, 61)).min(1.0);
        mix(
            colour * (1.0 + 0.12 * fractal(p * 2.0, 3, seed + 80)),
            vein,
            veins * (0.55 + 0.45 * fractal(p * 1.3, 2, seed + 90)).clamp(0.0, 1.0),
        )
    })
}

/// A leaf along its y axis: a midrib, veins and blotches.
pub fn leaf(colour: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        // Position in the unit sphere that the leaf was stretched from.
        let (x, y) = (s.point.x, s.point.y);
        let slanted = (y + 0.7 * x.abs()) * 5.0;
        let vein = (slanted - slanted.round()).abs() < 0.07 || x.abs() < 0.045;
        let blotch = 1.0 + 0.28 * fractal(s.point * 2.5 + f64::from(seed), 3, seed);
        colour * blotch * if vein { 1.35 } else { 1.0 }
    })
}
