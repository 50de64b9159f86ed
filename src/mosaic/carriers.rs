//! The carriers of a mosaic's colours in a block of a picture.

use crate::image::Luma;

/// Pixels from block to block; even, so that all blocks have the same phase.
pub const PITCH: u32 = 16;
/// Side of a block in pixels, with a taper of two pixels that the next block shares.
pub const SIDE: u32 = PITCH + 2;
/// Weights of a block's columns and rows, in quarters. Their alternating sum is 0, and so is that of a linear ramp: a
/// gradient of the scene bears no carrier.
const TAPER: [i16; SIDE as usize] = [1, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 3, 1];
/// Sum of the weights of a block.
const WEIGHT: f64 = (4 * PITCH * 4 * PITCH) as f64;

/// Carriers and texture of a block, in grey values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carriers {
    /// Amplitude of `(-1)^x`.
    pub along_x: f64,
    /// Amplitude of `(-1)^y`.
    pub along_y: f64,
    /// Amplitude of `(-1)^(x + y)`.
    pub diagonal: f64,
    /// Mean square of what is neither carrier nor gradient: second differences between pixels of one colour, two pixels
    /// apart, scaled to the variance of white noise.
    pub texture: f64,
}

impl Carriers {
    /// The carriers of the block of [`SIDE`] pixels from `(left, top)`, which are even and at least `SIDE` from the
    /// other edges.
    pub fn of(luma: &Luma, left: u32, top: u32) -> Self {
        let rows: [[i16; SIDE as usize]; SIDE as usize] = std::array::from_fn(|y| {
            let row = &luma.row(top + y as u32)[left as usize..][..SIDE as usize];
            std::array::from_fn(|x| row[x].into())
        });
        let [mut along_x, mut along_y, mut diagonal, mut squares] = [0; 4];
        for (y, row) in rows.iter().enumerate() {
            // At most 64 * 255: within 16 bits.
            let mean = (0..SIDE as usize).map(|x| TAPER[x] * row[x]).sum::<i16>();
            let alternating = (0..SIDE as usize).map(|x| sign(x) * TAPER[x] * row[x]).sum::<i16>();
            let [mean, alternating] = [mean, alternating].map(i32::from);
            let weight = i32::from(TAPER[y]);
            let signed_weight = i32::from(sign(y)) * weight;
            along_x += weight * alternating;
            along_y += signed_weight * mean;
            diagonal += signed_weight * alternating;
            squares += (4..SIDE as usize).map(|x| second_difference([row[x - 4], row[x - 2], row[x]])).sum::<i32>();
        }
        for y in 4..SIDE as usize {
            let [before, here, after] = [&rows[y - 4], &rows[y - 2], &rows[y]];
            squares += (0..SIDE as usize).map(|x| second_difference([before[x], here[x], after[x]])).sum::<i32>();
        }
        // A second difference of white noise has 1 + 4 + 1 times its variance.
        let count = 2 * SIDE * (SIDE - 4);
        Self {
            along_x: f64::from(along_x) / WEIGHT,
            along_y: f64::from(along_y) / WEIGHT,
            diagonal: f64::from(diagonal) / WEIGHT,
            texture: f64::from(squares) / f64::from(6 * count),
        }
    }

    /// Mean square of the carriers of red and blue.
    pub fn energy(&self) -> f64 {
        (self.along_x * self.along_x + self.along_y * self.along_y) / 2.0
    }
}

/// `(-1)^place`.
fn sign(place: usize) -> i16 {
    if place.is_multiple_of(2) { 1 } else { -1 }
}

/// Squared; the sum of a block's is below 2^30.
fn second_difference([before, here, after]: [i16; 3]) -> i32 {
    let difference = i32::from(before - 2 * here + after);
    difference * difference
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // Red 100 at the even columns and rows, green 60, blue 40: (R - B) / 4 and (R - 2 G + B) / 4.
        let red = Luma::from_fn((20, 20), |x, y| [100, 60, 40][(x % 2 + y % 2) as usize]);
        let expected = Carriers { along_x: 15.0, along_y: 15.0, diagonal: 5.0, texture: 0.0 };
        assert_eq!(Carriers::of(&red, 0, 0), expected);
        assert_eq!(Carriers::of(&red, 2, 2), expected);
        assert_eq!(expected.energy(), 225.0);
        // Green at the even columns and rows.
        let green = Luma::from_fn((20, 20), |x, y| [60, 100, 40, 60][(2 * (y % 2) + x % 2) as usize]);
        let expected = Carriers { along_x: -15.0, along_y: 15.0, diagonal: -5.0, texture: 0.0 };
        assert_eq!(Carriers::of(&green, 0, 0), expected);
    }

    #[test]
    fn a_gradient_has_neither_carriers_nor_texture() {
        let ramp = Luma::from_fn((18, 18), |x, y| (40 + 7 * x + 3 * y) as u8);
        assert_eq!(Carriers::of(&ramp, 0, 0), Carriers { along_x: 0.0, along_y: 0.0, diagonal: 0.0, texture: 0.0 });
    }

    #[test]
    fn a_point_is_texture() {
        let point = Luma::from_fn((18, 18), |x, y| if (x, y) == (8, 9) { 128 } else { 0 });
        let found = Carriers::of(&point, 0, 0);
        // 128 / 256 of an even column and an odd row; of 504 second differences four are 128 and two 256.
        assert_eq!([found.along_x, found.along_y, found.diagonal], [0.5, -0.5, -0.5]);
        assert_eq!(found.texture, f64::from(4 * 128 * 128 + 2 * 256 * 256) / (6.0 * 504.0));
    }
}
