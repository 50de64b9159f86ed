//! What surfaces look like, as colours on a screen (0 to 1), in millimetres.

use glam::{DVec3, dvec3};

use super::Surface;
use super::font::{any_ink, ink};
use super::math::{mix, smoothstep, wave};
use super::noise::{cells, fractal, gradient, hash, uniform};

/// The colour of each point of a surface.
pub type Texture = Box<dyn Fn(&Surface) -> DVec3 + Send + Sync>;

/// A colour as it is written in a style sheet: 0xrrggbb.
pub const fn rgb(hex: u32) -> DVec3 {
    dvec3(((hex >> 16) & 255) as f64 / 255.0, ((hex >> 8) & 255) as f64 / 255.0, (hex & 255) as f64 / 255.0)
}

fn flat(u: f64, v: f64) -> DVec3 {
    dvec3(u, v, 0.5)
}

/// Dust, wear and stains: a factor about 1.
fn wear(p: DVec3, seed: u32) -> f64 {
    1.0 + 0.10 * fractal(p / 45.0, 3, seed) + 0.07 * fractal(p / 5.0, 2, seed + 1)
}

/// One colour, a little worn.
pub fn painted(colour: DVec3, seed: u32) -> Texture {
    Box::new(move |s| colour * wear(s.point, seed))
}

/// One colour with next to nothing on it: `contrast` is the share of the grain.
pub fn smooth(colour: DVec3, contrast: f64, seed: u32) -> Texture {
    Box::new(move |s| {
        colour * (1.0 + contrast * (fractal(s.point / 60.0, 2, seed) + 0.5 * gradient(s.point / 6.0, seed)))
    })
}

/// Grain of wood along u at a place of a board.
fn grain(u: f64, v: f64, seed: u32, light: DVec3, dark: DVec3) -> DVec3 {
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

/// A book: cloth with a title on its front and its spine, and pages on the other three edges.
pub fn book(cloth: DVec3, print: DVec3, title: &'static str, height: f64, spine: usize, seed: u32) -> Texture {
    Box::new(move |s| {
        let [u, v] = s.uv;
        let weave = 1.0 + 0.10 * gradient(flat(u / 1.4, v / 1.4), seed) + 0.07 * fractal(s.point / 30.0, 3, seed);
        let titled = s.face == spine;
        if titled && (ink(title, height, u, v) || (u.abs() > 62.0 && u.abs() < 65.0)) {
            return print;
        }
        match s.face {
            2 | 3 => cloth * weave,
            face if face == spine => cloth * weave,
            _ => rgb(0xe4d9bd) * (0.86 + 0.22 * gradient(dvec3(u / 60.0, v / 1.3, 0.5), seed)),
        }
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
        let colour = if ink(name, 19.0, around, v - 6.0) {
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

/// A leaf along its y axis: a midrib, veins and blotches.
pub fn leaf(colour: DVec3, seed: u32) -> Texture {
    Box::new(move |s| {
        // In the unit sphere that the leaf was stretched from.
        let (x, y) = (s.point.x, s.point.y);
        let slanted = (y + 0.7 * x.abs()) * 5.0;
        let vein = (slanted - slanted.round()).abs() < 0.07 || x.abs() < 0.045;
        let blotch = 1.0 + 0.28 * fractal(s.point * 2.5 + f64::from(seed), 3, seed);
        colour * blotch * if vein { 1.35 } else { 1.0 }
    })
}
