//! Paper and board with print on them: maps, pages, books, labels.

use glam::{DVec3, dvec3};

use super::{Texture, flat, rgb, wear};
use crate::renderer::font::{any_ink, ink};
use crate::renderer::math::{mix, smoothstep, wave};
use crate::renderer::noise::{cells, fractal, gradient, hash, uniform};

/// A map: sea, land by height, coast lines, a grid and the names of places.
pub fn map(scale: f64, half: [f64; 2], title: &'static str, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let p = flat(u / scale, v / scale);
        let height = fractal(p, 6, seed) + 0.05;
        let relief = 1.0 + 1.3 * (fractal(p + dvec3(0.012, 0.012, 0.0), 6, seed) + 0.05 - height);
        let mut colour = sea_or_land(height) * if height > 0.0 { relief.clamp(0.6, 1.35) } else { 1.0 };
        let grid = |x: f64| (x / 32.0 - (x / 32.0).round()).abs() * 32.0 < 0.5;
        if grid(u) || grid(v) {
            colour *= 0.82;
        }
        let road = gradient(p * 1.7 + dvec3(4.0, 2.0, 0.0), seed + 30).abs();
        if height > 0.03 && road < 0.02 {
            colour = rgb(0xb8453a);
        }
        let (cell_u, cell_v) = ((u / 38.0).floor(), (v / 24.0).floor());
        let (i, j) = (cell_u as i64, cell_v as i64);
        let name_v = v - (cell_v + 0.3 + 0.4 * uniform(i, j, 3, seed)) * 24.0;
        if height > 0.0
            && uniform(i, j, 4, seed) < 0.6
            && words(u - cell_u * 38.0 - 4.0, name_v, 3.6, 28.0, seed ^ hash(i, j, 5, seed))
        {
            colour = rgb(0x2b2522);
        }
        let margin = (half[0] - u.abs()).min(half[1] - v.abs());
        if margin < 9.0 {
            colour = if (6.0..7.2).contains(&margin) { rgb(0x40444c) } else { rgb(0xefe9d8) };
        }
        let (tu, tv) = (u + half[0] * 0.45, v - half[1] + 26.0);
        if tu.abs() < half[0] * 0.45 && tv.abs() < 10.0 {
            colour = if ink(title, 11.0, tu, tv) { rgb(0x2a2f45) } else { rgb(0xf3eedf) };
        }
        colour * wear(s.point, seed + 9)
    })
}

/// A globe about the y axis: sea, land by height, coast lines, circles of latitude.
pub fn globe(scale: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        let height = fractal(s.point / scale, 6, seed) + 0.02;
        let mut colour = sea_or_land(height);
        let latitude = s.uv[1] / 24.0;
        if (latitude - latitude.round()).abs() < 0.025 {
            colour *= 0.8;
        }
        colour * wear(s.point, seed + 9)
    })
}

/// The colours of a map at a height, the sea being below 0.
fn sea_or_land(height: f64) -> DVec3 {
    let colour = if height < 0.0 {
        mix(rgb(0xa9cfe0), rgb(0x6fa6c6), smoothstep(0.0, -0.5, height))
    } else if height < 0.22 {
        mix(rgb(0xb6cf8e), rgb(0xe6dfa4), height / 0.22)
    } else {
        mix(rgb(0xe6dfa4), rgb(0xa9764a), smoothstep(0.22, 0.62, height))
    };
    mix(colour, rgb(0x35506b), 0.8 * smoothstep(0.022, 0.008, height.abs()))
}

/// Whether there is ink in one line of made-up words, `height` high, that begins at (0, 0).
fn words(u: f64, v: f64, height: f64, length: f64, seed: u32) -> bool {
    let dot = height / 7.0;
    let (column, row) = (u / dot, 7.0 - v / dot);
    if !(0.0..length / dot).contains(&column) || !(0.0..7.0).contains(&row) {
        return false;
    }
    let letter = (column / 6.0) as i64;
    uniform(letter, 0, 0, seed) < 0.84 && any_ink(hash(letter, 0, 1, seed), column % 6.0, row)
}

/// A printed page: a heading, lines of text in paragraphs, and a figure.
pub fn page(half: [f64; 2], heading: &'static str, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let paper = rgb(0xf1ecdf) * (1.0 + 0.4 * (wear(s.point, seed) - 1.0));
        let down = half[1] - v;
        let left = u + half[0] - 14.0;
        let width = 2.0 * half[0] - 28.0;
        if down < 34.0 {
            return if ink(heading, 11.0, u, 22.0 - down) { rgb(0x23232b) } else { paper };
        }
        let figure = [u - half[0] * 0.42, v + half[1] * 0.20];
        if figure[0].abs() < half[0] * 0.40 && figure[1].abs() < half[1] * 0.28 {
            let tone = fractal(flat(figure[0] / 24.0, figure[1] / 24.0), 4, seed + 50);
            return mix(rgb(0x34506e), rgb(0xe2b46c), (tone + 0.5).clamp(0.0, 1.0));
        }
        let beside = figure[1].abs() < half[1] * 0.30;
        let pitch = 8.4;
        let line = (down / pitch).floor();
        let last = uniform(line as i64, 0, 9, seed) < 0.16;
        let full = if beside { width * 0.47 } else { width };
        let length = if last { full * 0.45 } else { full };
        if down < 2.0 * half[1] - 14.0
            && words(left, (line + 1.0) * pitch - down, 5.2, length, seed.wrapping_add(line as u32 * 77))
        {
            rgb(0x2c2c33)
        } else {
            paper
        }
    })
}

/// A book: cloth with a title on its spine, the front of its box, and pages on the other three edges.
pub fn book(cloth: DVec3, print: DVec3, title: &'static str, height: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let weave = 1.0 + 0.10 * gradient(flat(u / 1.4, v / 1.4), seed) + 0.07 * fractal(s.point / 30.0, 3, seed);
        let spine = s.face == 4;
        if spine && (ink(title, height, u, v) || (u.abs() > 62.0 && u.abs() < 65.0)) {
            return print;
        }
        if spine || s.face == 2 || s.face == 3 {
            cloth * weave
        } else {
            rgb(0xe4d9bd) * (0.86 + 0.22 * gradient(dvec3(u / 60.0, v / 1.3, 0.5), seed))
        }
    })
}

/// Brown board with printed marks and a strip of tape on its upper face.
pub fn carton(mark: &'static str, height: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let flute = 1.0 + 0.035 * wave(u / 5.0);
        let fibre = 1.0 + 0.16 * fractal(dvec3(u / 14.0, v / 4.0, s.face as f64 * 7.0), 3, seed);
        let board = rgb(0xb88e5e) * flute * fibre;
        if s.face == 2 {
            return if v.abs() < 11.0 { mix(board, rgb(0xd9c49a), 0.75) } else { board };
        }
        if ink(mark, height, u, v - height * 0.6) || words(u + 40.0, v + height * 1.1, 6.0, 80.0, seed + s.face as u32)
        {
            return mix(board, rgb(0x2d2622), 0.85);
        }
        board
    })
}

/// A tin with a paper label: bands, a name all around, small print, and bare metal at both ends.
pub fn tin(half: f64, name: &'static str, colours: [DVec3; 3], seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        if s.face > 0 || v.abs() > half - 6.0 {
            return rgb(0xb9bcc0) * (1.0 + 0.25 * wave(v / 3.0)) * wear(s.point, seed);
        }
        let period = 112.0;
        let around = u - (u / period).round() * period;
        let colour = if ink(name, 16.0, around, v - 6.0) {
            colours[2]
        } else if v > half * 0.55 || words(around + 42.0, v + half * 0.30, 5.5, 84.0, seed) {
            colours[1]
        } else if v < -half * 0.5 {
            let (_, border, id) = cells(u / 11.0, v / 11.0, seed);
            mix(colours[1], colours[2], f64::from(id % 100) / 100.0) * mix(0.7, 1.0, smoothstep(0.0, 0.15, border))
        } else {
            colours[0]
        };
        colour * wear(s.point, seed + 1)
    })
}
