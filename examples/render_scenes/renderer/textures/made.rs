//! Cloth, paint, glaze, a calibration target.

use glam::{DVec3, dvec3};

use super::natural::grain;
use super::{Texture, flat, rgb, wear};
use crate::renderer::math::{mix, smoothstep, wave};
use crate::renderer::noise::{cells, fractal, gradient};

/// Woven cloth in a tartan of `sett` mm.
pub fn tartan(sett: f64, colours: [DVec3; 4], seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let stripe = |x: f64| {
            let x = (x / sett - (x / sett).floor()) * 24.0;
            match x as u32 {
                0..=6 => 0,
                7..=8 | 22..=23 => 1,
                9..=13 | 17..=21 => 2,
                14 | 16 => 1,
                _ => 3,
            }
        };
        // Threads of 1.6 mm in twill: which of warp and weft lies on top moves by one thread from row to row.
        let (warp, weft) = ((u / 1.6).floor(), (v / 1.6).floor());
        let over = (warp + weft).rem_euclid(4.0) < 2.0;
        let thread = if over { stripe(u) } else { stripe(v) };
        let round = if over { wave(u / 1.6 + 0.75) } else { wave(v / 1.6 + 0.75) };
        let yarn = 1.0 + 0.10 * round + 0.20 * fractal(flat(u / 3.0, v / 3.0), 2, seed);
        colours[thread] * yarn * wear(flat(u, v), seed + 2)
    })
}

/// A calibration target: `columns` x `rows` squares of `cell` mm on white.
pub fn checker(cell: f64, columns: f64, rows: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        let (x, y) = (s.uv[0] / cell + columns / 2.0, s.uv[1] / cell + rows / 2.0);
        let on_board = (0.0..columns).contains(&x) && (0.0..rows).contains(&y);
        let black = on_board && (x.floor() + y.floor()).rem_euclid(2.0) == 0.0;
        if black { rgb(0x1d1d22) } else { rgb(0xe9e6dd) * wear(s.point, seed) }
    })
}

/// A picture of broad brush strokes in a frame.
pub fn painting(half: [f64; 2], palette: [DVec3; 5], seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let margin = (half[0] - u.abs()).min(half[1] - v.abs());
        if s.face != 4 || margin < 13.0 {
            let along = if half[0] - u.abs() < half[1] - v.abs() { [v, u] } else { [u, v] };
            let lip = if (10.5..13.0).contains(&margin) { 0.55 } else { 1.0 };
            return grain(along[0], along[1], seed, rgb(0xb98a4a), rgb(0x5e3c1c)) * lip;
        }
        let warp = 26.0 * fractal(flat(u / 70.0, v / 70.0), 3, seed + 1);
        let (_, border, id) = cells((u + warp) / 34.0, (v - warp) / 20.0, seed);
        let (_, _, dab) = cells((u + 0.4 * warp) / 9.0, (v + u * 0.3) / 4.0, seed + 2);
        let sky = ((v / half[1] + 1.0) * 1.6 + f64::from(id % 256) / 256.0 * 1.8).clamp(0.0, 3.99);
        let base = mix(palette[sky as usize], palette[sky as usize + 1], sky.fract());
        let bristle = 1.0 + 0.12 * fractal(dvec3(u / 12.0, v / 1.6, 0.5), 2, seed + 3);
        let touch = 0.80 + 0.36 * f64::from(dab % 256) / 256.0;
        base * bristle * touch * mix(0.8, 1.0, smoothstep(0.0, 0.12, border))
    })
}

/// Glazed clay with bands of ornament about the y axis.
pub fn glazed(clay: DVec3, glaze: DVec3, pattern: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        let [around, v] = s.uv;
        let run = 6.0 * gradient(dvec3(around / 14.0, 0.5, 0.5), seed);
        let speckle = smoothstep(0.34, 0.5, gradient(s.point / 3.4, seed + 2));
        let mut colour = if v > -62.0 + run { glaze } else { clay };
        let zigzag = 7.0 * (around / 16.0 - (around / 16.0).round()).abs() * 2.0;
        if (20.0..23.0).contains(&v)
            || (-18.0..-15.0).contains(&v)
            || (v - 2.0 - zigzag).abs() < 2.0
            || (v + 5.0 - zigzag).abs() < 1.2
        {
            colour = pattern;
        }
        mix(colour, clay * 0.5, 0.6 * speckle) * (1.0 + 0.16 * fractal(s.point / 26.0, 4, seed + 4))
    })
}
