//! A texture's texels to luma, from the definition.

use crate::image::{Luma, Plane, luma_of};

/// The texels of a picture. Whether bytes are declared sRGB does not matter: luma is that of the bytes.
#[derive(Clone, Debug)]
pub enum Texels {
    /// Red, green, blue and something else.
    Rgba(Plane<[u8; 4]>),
    /// Grey.
    Grey(Plane<u8>),
    /// Red, green, blue and something else, in the bits of IEEE 754's binary16.
    RgbaHalf(Plane<[u16; 4]>),
    /// Grey, in such bits.
    GreyHalf(Plane<u16>),
}

/// Luma of texels.
pub fn luma_texture(texels: &Texels) -> Luma {
    match texels {
        Texels::Rgba(picture) => picture.map(|&[r, g, b, _]| luma_of([r, g, b])),
        Texels::Grey(picture) => picture.clone(),
        Texels::RgbaHalf(picture) => picture.map(|&[r, g, b, _]| luma_of([r, g, b].map(level))),
        Texels::GreyHalf(picture) => picture.map(|&grey| level(grey)),
    }
}

/// The byte that is nearest to 255 times a half, halves of a byte upwards; below 0 and above 1 cut off.
fn level(half: u16) -> u8 {
    let (exponent, fraction) = (half >> 10 & 31, f64::from(half & 1023) / 1024.0);
    let magnitude = match exponent {
        0 => fraction * 2f64.powi(-14),
        exponent => (1.0 + fraction) * 2f64.powi(i32::from(exponent) - 15),
    };
    let value = if half >> 15 == 1 { -magnitude } else { magnitude };
    (255.0 * value.clamp(0.0, 1.0) + 0.5).floor() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_by_hand() {
        // 0, -0, 1, -1, 0.5 (127.5, up), 2, 2^-14 (0.0156), the largest number, 0.0009766 (0.249), 0.001953 (0.498),
        // 0.001962 (0.5003).
        let halves = [0x0000, 0x8000, 0x3c00, 0xbc00, 0x3800, 0x4000, 0x0400, 0x7bff, 0x1400, 0x1800, 0x1805];
        assert_eq!(halves.map(level), [0, 0, 255, 0, 128, 255, 0, 255, 0, 0, 1]);
    }
}
