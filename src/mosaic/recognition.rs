//! Recognition of a mosaic from its luma alone.

use super::carriers::{Carriers, PITCH, SIDE};
use crate::image::{Luma, Size};

/// Largest number of blocks that are looked at, evenly over the picture.
const BLOCKS: u32 = 512;
/// Smallest energy of the carriers of red and blue in a block that is evidence, in squared grey values, and smallest share
/// of its texture: the texture of a scene, a halftone or a brick wall bears carriers by chance or by its period, with less.
const EVIDENCE: (f64, f64) = (1.0, 0.25);
/// Smallest number of blocks with evidence, and their smallest share of the blocks that are not constant.
const SUPPORT: (usize, f64) = (8, 0.05);
/// Smallest correlation of the carriers along x and y. Both green pixels of a cell are equal in a mosaic, which makes it 1
/// or -1; stripes, interlaced frames and screens have 0.
const CORRELATION: f64 = 0.9;
/// Smallest relative difference of the carriers of red and blue from the diagonal one: a lattice of dots, one pixel of four,
/// has equal carriers.
const COLORS: f64 = 0.05;
/// Smallest number of grey values: a dithered picture has fewer.
const LEVELS: usize = 16;

/// The parity of `x + y` at the green pixels of a mosaic; `None` for any other picture.
///
/// A mosaic is recognised by its colours: one in which red and blue are equal everywhere is not.
pub fn green_parity(luma: &Luma) -> Option<u32> {
    let blocks: Vec<Carriers> = corners(luma.size()).map(|(left, top)| Carriers::of(luma, left, top)).collect();
    let lively = blocks.iter().filter(|block| block.energy() > 0.0 || block.texture > 0.0).count();
    let is_evidence = |block: &&Carriers| block.energy() >= EVIDENCE.0 && block.energy() >= EVIDENCE.1 * block.texture;
    let evidence: Vec<&Carriers> = blocks.iter().filter(is_evidence).collect();
    if evidence.len() < SUPPORT.0 || (evidence.len() as f64) < SUPPORT.1 * lively as f64 {
        return None;
    }
    let sum = |value: &dyn Fn(&Carriers) -> f64| evidence.iter().map(|&block| value(block)).sum::<f64>();
    let correlation = sum(&|block| block.along_x * block.along_y) / sum(&Carriers::energy);
    if correlation.abs() < CORRELATION {
        return None;
    }
    // With red or blue at the even columns and rows both carriers have one sign, and green is where x + y is odd.
    let (sign, green) = if correlation > 0.0 { (1.0, 1) } else { (-1.0, 0) };
    let red_blue = |block: &Carriers| (block.along_x + sign * block.along_y) / 2.0;
    let squares = sum(&|block| red_blue(block) * red_blue(block));
    let both = squares + sum(&|block| block.diagonal * block.diagonal);
    let like_dots = 2.0 * sum(&|block| red_blue(block) * block.diagonal).abs() / both;
    (1.0 - like_dots >= COLORS && levels(luma) >= LEVELS).then_some(green)
}

/// Number of grey values in a picture.
fn levels(luma: &Luma) -> usize {
    let mut seen = [false; 256];
    luma.data().iter().for_each(|&grey| seen[usize::from(grey)] = true);
    seen.into_iter().filter(|&seen| seen).count()
}

/// The upper left pixels of at most [`BLOCKS`] blocks, evenly over a picture.
fn corners(Size { width, height }: Size) -> impl Iterator<Item = (u32, u32)> {
    let [columns, rows] = [width, height].map(|side| side.saturating_sub(SIDE - PITCH) / PITCH);
    let within = |step: u32| columns.div_ceil(step) * rows.div_ceil(step) <= BLOCKS;
    let step = (1..).find(|&step| within(step)).unwrap_or(1) as usize;
    let at = move |index: u32| index * PITCH;
    (0..rows).step_by(step).flat_map(move |y| (0..columns).step_by(step).map(move |x| (at(x), at(y))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene of patches of 24 px, each of one colour, with shading.
    fn scene(x: u32, y: u32) -> [u32; 3] {
        let patch = (x / 24 * 7 + y / 24 * 13) % 5;
        let shade = (x + y) % 24;
        [[90, 70, 50], [40, 60, 90], [120, 120, 120], [60, 100, 40], [150, 90, 60]][patch as usize]
            .map(|value| value + shade)
    }

    fn grey(x: u32, y: u32) -> u32 {
        let [red, green, blue] = scene(x, y);
        (red + 2 * green + blue) / 4
    }

    fn picture(value: impl Fn(u32, u32) -> u32) -> Luma {
        Luma::from_fn((200, 150), |x, y| value(x, y).min(255) as u8)
    }

    /// The mosaic of the scene, red at the pixels of the parities `red` of column and row.
    fn mosaic((red_x, red_y): (u32, u32)) -> Luma {
        picture(|x, y| scene(x, y)[((x + red_x) % 2 + (y + red_y) % 2) as usize])
    }

    /// A pseudo-random value from 0 to `range - 1`.
    fn noise(x: u32, y: u32, range: u32) -> u32 {
        let mixed = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77);
        ((mixed ^ mixed >> 15).wrapping_mul(0x27D4_EB2F) >> 16) % range
    }

    #[test]
    fn a_mosaic_of_any_phase_is_recognised() {
        for (red, green) in [((0, 0), 1), ((1, 1), 1), ((1, 0), 0), ((0, 1), 0)] {
            let mosaic = mosaic(red);
            assert_eq!(green_parity(&mosaic), Some(green));
            let noisy = picture(|x, y| u32::from(mosaic.get(x, y)) + noise(x, y, 17));
            assert_eq!(green_parity(&noisy), Some(green), "noise of a standard deviation of 5");
        }
    }

    #[test]
    fn a_scene_and_its_noise_are_not_mosaics() {
        assert_eq!(green_parity(&picture(grey)), None);
        assert_eq!(green_parity(&picture(|x, y| noise(x, y, 256))), None);
        assert_eq!(green_parity(&picture(|_, _| 128)), None);
        for size in [(1, 1), (1, 99), (17, 17), (18, 18)] {
            assert_eq!(green_parity(&Luma::from_fn(size, |x, y| noise(x, y, 256) as u8)), None);
        }
    }

    #[test]
    fn fine_patterns_are_not_mosaics() {
        type Pattern<'a> = &'a dyn Fn(u32, u32) -> u32;
        let patterns: [(&str, Pattern); 12] = [
            ("a checkerboard of 1 px", &|x, y| 255 * ((x + y) % 2)),
            ("a checkerboard of 2 px", &|x, y| 255 * ((x / 2 + y / 2) % 2)),
            ("columns", &|x, _| 255 * (x % 2)),
            ("rows", &|_, y| 255 * (y % 2)),
            ("interlaced frames", &|x, y| grey(x + 9 * (y % 2), y)),
            ("a lattice of dots", &|x, y| if x % 2 + y % 2 == 0 { grey(x, y) } else { 0 }),
            ("a lattice of holes", &|x, y| if x % 2 + y % 2 == 0 { 0 } else { grey(x, y) }),
            ("a lattice of three levels", &|x, y| [200, 120, 20][(x % 2 + y % 2) as usize]),
            ("ordered dither", &|x, y| {
                255 * u32::from(grey(x, y) > [32, 160, 224, 96][(x % 2 + 2 * (y % 2)) as usize])
            }),
            ("a halftone of 4 px", &|x, y| {
                if (x % 4).abs_diff(2) + (y % 4).abs_diff(2) < grey(x, y) / 40 { 0 } else { 255 }
            }),
            ("bricks of 4x4", &|x, y| if y % 4 == 0 || (x + y / 4 % 2 * 2) % 4 == 0 { 60 } else { 150 }),
            ("bricks of 8x8", &|x, y| if y % 8 == 0 || (x + y / 8 % 2 * 4) % 8 == 0 { 60 } else { 150 }),
        ];
        for (name, pattern) in patterns {
            assert_eq!(green_parity(&picture(pattern)), None, "{name}");
        }
    }

    #[test]
    fn blocks_are_few_and_within_the_picture() {
        for size in [(1, 1), (18, 18), (450, 375), (6000, 4000), (1 << 19, 18), (40, 1 << 19)] {
            let found: Vec<_> = corners(size.into()).collect();
            assert!(found.len() <= BLOCKS as usize && (found.len() > BLOCKS as usize / 8 || size.0 * size.1 < 1 << 18));
            assert!(found.iter().all(|&(x, y)| x % 2 + y % 2 == 0 && x + SIDE <= size.0 && y + SIDE <= size.1));
        }
    }
}
