//! Conversion of texels to luma, from the definition.

use crate::image::{Luma, Plane, luma_of};

/// The texels of a picture. 8-bit texels count as stored, whether the format is sRGB or not.
#[derive(Clone, Debug)]
pub enum Texels {
    /// Red, green, blue, and a fourth channel that is ignored.
    Rgba(Plane<[u8; 4]>),
    /// Grey levels.
    Grey(Plane<u8>),
    /// Red, green, blue, and a fourth channel that is ignored, as IEEE 754 binary16.
    RgbaHalf(Plane<[u16; 4]>),
    /// Grey levels, as IEEE 754 binary16.
    GreyHalf(Plane<u16>),
}

/// Converts texels to luma.
pub fn luma_texture(texels: &Texels) -> Luma {
    match texels {
        Texels::Rgba(picture) => picture.map(|&[r, g, b, _]| luma_of([r, g, b])),
        Texels::Grey(picture) => picture.clone(),
        Texels::RgbaHalf(picture) => picture.map(|&[r, g, b, _]| luma_of([r, g, b].map(level))),
        Texels::GreyHalf(picture) => picture.map(|&grey| level(grey)),
    }
}

/// Converts a binary16 to the nearest byte of 255 times its value, halves up, clamped to 0..1.
pub(super) fn level(half: u16) -> u8 {
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
