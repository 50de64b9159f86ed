//! Hashes of integers, and smooth noise from them.

use glam::DVec3;

use super::math::mix;

/// A well mixed hash of a lattice point (the finaliser of MurmurHash3 after each coordinate).
pub fn hash(x: i64, y: i64, z: i64, seed: u32) -> u32 {
    [x, y, z].iter().fold(seed.wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995, |h, &c| {
        let mut h = (h ^ c as u32).wrapping_mul(0x85eb_ca6b);
        h ^= h >> 13;
        h = h.wrapping_mul(0xc2b2_ae35);
        h ^ (h >> 16)
    })
}

/// The hash as a number from 0 up to, but not reaching, 1.
pub fn uniform(x: i64, y: i64, z: i64, seed: u32) -> f64 {
    f64::from(hash(x, y, z, seed)) / 4_294_967_296.0
}

/// An approximately normal number with mean 0 and standard deviation 1: the sum of twelve uniform numbers.
pub fn normal(x: i64, y: i64, z: i64, seed: u32) -> f64 {
    (0..12).map(|i| uniform(x, y, z, seed.wrapping_mul(12).wrapping_add(i))).sum::<f64>() - 6.0
}

/// Gradient noise, about -1 to 1 (Perlin, Improving Noise, SIGGRAPH 2002).
pub fn gradient(p: DVec3, seed: u32) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let (x, y, z) = (cell.x as i64, cell.y as i64, cell.z as i64);
    let corner = |i: i64, j: i64, k: i64| {
        let d = f - DVec3::new(i as f64, j as f64, k as f64);
        let h = hash(x + i, y + j, z + k, seed) >> 8;
        // The twelve directions to the edges of a cube; four of them twice, so that no division is needed.
        let (a, b) = match h & 12 {
            0 => (d.x, d.y),
            4 => (d.x, d.z),
            8 => (d.y, d.z),
            _ if h & 1 == 0 => (d.x, d.y),
            _ => (d.y, d.z),
        };
        (if h & 16 == 0 { a } else { -a }) + (if h & 32 == 0 { b } else { -b })
    };
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let row = |j: i64, k: i64| mix(corner(0, j, k), corner(1, j, k), u);
    mix(mix(row(0, 0), row(1, 0), v), mix(row(0, 1), row(1, 1), v), w)
}

/// Noise at `octaves` scales, each half as wide and half as strong as the one before; about -1 to 1.
pub fn fractal(p: DVec3, octaves: u32, seed: u32) -> f64 {
    let (mut sum, mut amplitude, mut q) = (0.0, 1.0, p);
    for octave in 0..octaves {
        sum += amplitude * gradient(q, seed.wrapping_add(octave * 131));
        amplitude *= 0.5;
        q *= 2.03;
    }
    sum
}

/// The nearest of one random point per cell of a square lattice: (distance to it, how much farther the second nearest
/// is, its hash), the pattern of cobbles and of brush strokes (Worley, A Cellular Texture Basis Function, 1996).
pub fn cells(u: f64, v: f64, seed: u32) -> (f64, f64, u32) {
    let (x, y) = (u.floor() as i64, v.floor() as i64);
    let (mut first, mut second, mut id) = (f64::INFINITY, f64::INFINITY, 0);
    for (i, j) in (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j))) {
        let du = i as f64 + uniform(i, j, 0, seed) - u;
        let dv = j as f64 + uniform(i, j, 1, seed) - v;
        let d = (du * du + dv * dv).sqrt();
        if d < first {
            (second, first, id) = (first, d, hash(i, j, 2, seed));
        } else if d < second {
            second = d;
        }
    }
    (first, second - first, id)
}
