//! Random inputs from a seed, the same on every machine.

use crate::{
    dense::{Interpolation, View},
    disparity::DisparityRange,
    image::{Luma, Size},
};

/// A pseudorandom generator. SplitMix64: Steele, Lea, Flood: 'Fast splittable pseudorandom number generators', OOPSLA
/// 2014.
pub struct Dice(u64);

impl Dice {
    /// Seeds the generator with `name` and `seed`.
    pub fn new(name: &str, seed: u32) -> Self {
        let name = name.bytes().fold(0, |hash: u64, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
        Self(name << 32 ^ u64::from(seed))
    }

    /// Draws a `u32`.
    pub fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 32) as u32
    }

    /// Draws a number below `count`.
    pub fn below(&mut self, count: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(count)) >> 32) as u32
    }

    /// Draws a number from `least` to `most`.
    pub fn between(&mut self, least: i32, most: i32) -> i32 {
        least + self.below((most - least + 1) as u32) as i32
    }

    /// Draws one of `choices`.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u32) as usize]
    }

    /// Draws true or false.
    pub fn coin(&mut self) -> bool {
        self.below(2) == 1
    }

    /// Draws a view.
    pub fn view(&mut self) -> View {
        self.pick(&[View::Left, View::Right])
    }

    /// Draws an interpolation.
    pub fn interpolation(&mut self) -> Interpolation {
        self.pick(&Interpolation::ALL)
    }

    /// Draws a range of up to `most` disparities, 0 among them, so that in any picture some pixel has a partner.
    pub fn range(&mut self, most: u32) -> DisparityRange {
        let count = 1 + self.below(most);
        DisparityRange { min: -(self.below(count.min(24)) as i32), count }
    }

    /// Draws a picture: mostly smooth noise, sometimes a harder one.
    pub fn picture(&mut self, size: impl Into<Size>) -> Luma {
        let Size { width, height } = size.into();
        let seed = self.word();
        match self.below(16) {
            0 => Luma::from_fn((width, height), |_, _| self.word() as u8),
            // Black and white in blocks.
            1 => Luma::from_fn((width, height), |x, y| ((x / 5 + y / 3) % 2 * 255) as u8),
            // Low contrast.
            2 => smooth_noise((width, height), seed).map(|&value| 100 + value / 64),
            // One grey value.
            3 => Luma::filled((width, height), self.pick(&[0, 77, 255])),
            _ => smooth_noise((width, height), seed),
        }
    }

    /// Draws a pair: two planes with a step between them and some noise in the left view; sometimes views with nothing
    /// in common.
    pub fn pair(&mut self, size: impl Into<Size>) -> [Luma; 2] {
        let Size { width, height } = size.into();
        let right = self.picture((width, height));
        if self.below(8) == 0 {
            return [self.picture((width, height)), right];
        }
        let (upper, lower) = (i64::from(self.between(-4, 12)), i64::from(self.between(0, 24)));
        let noise = self.pick(&[1, 4, 16]);
        let left = Luma::from_fn((width, height), |x, y| {
            let disparity = if y < height / 2 { upper } else { lower };
            right.get_clamped(i64::from(x) - disparity, i64::from(y)).saturating_add(self.below(noise) as u8)
        });
        [left, right]
    }
}

/// A picture of smooth noise and some grain, different for each `seed`.
pub fn smooth_noise(size: impl Into<Size>, seed: u32) -> Luma {
    let Size { width, height } = size.into();
    // A value for every corner of a grid of 8 px, blended between the corners.
    let corner = |x: u32, y: u32| {
        let mut hash = x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
        hash = (hash ^ hash >> 15).wrapping_mul(0x2C1B_3C6D);
        hash = (hash ^ hash >> 12).wrapping_mul(0x297A_2D39);
        (hash ^ hash >> 15) >> 24
    };
    Luma::from_fn((width, height), |x, y| {
        let (i, j, fx, fy) = (x / 8, y / 8, x % 8, y % 8);
        let top = (8 - fx) * corner(i, j) + fx * corner(i + 1, j);
        let bottom = (8 - fx) * corner(i, j + 1) + fx * corner(i + 1, j + 1);
        let smooth = ((8 - fy) * top + fy * bottom) / 64;
        (smooth * 15 / 16 + corner(x + 7919, y) / 16) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_from_name_and_seed() {
        let words = |name, seed| {
            let mut dice = Dice::new(name, seed);
            [0; 4].map(|_| dice.word())
        };
        assert_eq!(words("pad", 1), words("pad", 1));
        assert_ne!(words("pad", 1), words("pad", 2));
        assert_ne!(words("pad", 1), words("path", 1));
    }

    #[test]
    fn numbers_reach_both_ends() {
        let mut dice = Dice::new("", 0);
        let mut numbers: Vec<i32> = (0..1000).map(|_| dice.between(-3, 4)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers, [-3, -2, -1, 0, 1, 2, 3, 4]);
        for _ in 0..1000 {
            let range = dice.range(9);
            assert!(range.count <= 9 && range.contains(0));
        }
    }
}
