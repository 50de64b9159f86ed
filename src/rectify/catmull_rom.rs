//! Weights of Catmull-Rom interpolation, in integers.

/// Bits after the point of positions and weights: positions are in 1/2048 px.
pub const SUBPIXEL_BITS: u32 = 11;

/// Weights, in `1 / 2^SUBPIXEL_BITS`, of the pixels at -1, 0, 1 and 2 for a position `fraction / 2^SUBPIXEL_BITS` px right
/// of pixel 0 or below it; 0 <= `fraction` < `2^SUBPIXEL_BITS`.
///
/// Cubic convolution with a = -1/2: Keys, 'Cubic convolution interpolation for digital image processing', IEEE TASSP
/// 29(6), 1981, equation 15. The outer weights, `-t (1 - t)^2 / 2` and `-t^2 (1 - t) / 2`, are rounded to the nearest. The
/// inner weights follow from them, so that the sum is exactly 1 and a ramp is reproduced exactly.
pub(crate) fn weights(fraction: i32) -> [i32; 4] {
    let one = 1 << SUBPIXEL_BITS;
    let rest = one - fraction;
    // At most 4/27 of 2^(3 SUBPIXEL_BITS), below 2^31.
    let outer = |near: i32, far: i32| -((near * far * far + one * one) >> (2 * SUBPIXEL_BITS + 1));
    let (first, last) = (outer(fraction, rest), outer(rest, fraction));
    [first, rest - 2 * first + last, fraction - 2 * last + first, last]
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: i32 = 1 << SUBPIXEL_BITS;

    #[test]
    fn weights_by_hand() {
        assert_eq!(weights(0), [0, ONE, 0, 0]);
        assert_eq!(weights(ONE / 2).map(|weight| 16 * weight), [-ONE, 9 * ONE, 9 * ONE, -ONE]);
        // At 1/4: -9/128, 111/128, 29/128, -3/128.
        assert_eq!(weights(ONE / 4).map(|weight| 128 * weight), [-9 * ONE, 111 * ONE, 29 * ONE, -3 * ONE]);
    }

    #[test]
    fn weights_add_up_and_reproduce_a_ramp_at_every_fraction() {
        for fraction in 0..ONE {
            let [a, b, c, d] = weights(fraction);
            assert_eq!((a + b + c + d, c + 2 * d - a), (ONE, fraction));
            if fraction > 0 {
                assert_eq!(weights(ONE - fraction), [d, c, b, a], "the mirror image of {fraction}");
            }
        }
    }

    #[test]
    fn weights_are_keys_to_within_three_halves_of_a_unit() {
        for fraction in 0..ONE {
            let t = f64::from(fraction) / f64::from(ONE);
            let keys = [
                -0.5 * t * t * t + t * t - 0.5 * t,
                1.5 * t * t * t - 2.5 * t * t + 1.0,
                -1.5 * t * t * t + 2.0 * t * t + 0.5 * t,
                0.5 * t * t * t - 0.5 * t * t,
            ];
            for (weight, exact) in weights(fraction).into_iter().zip(keys) {
                assert!((f64::from(weight) - f64::from(ONE) * exact).abs() <= 1.5 + 1e-9, "{fraction}");
            }
        }
    }

    /// A sum over 4x4 pixels, and one half, in the arithmetic of the kernel.
    #[test]
    fn sums_fit_in_32_bits() {
        let most = (0..ONE).map(|fraction| weights(fraction).map(i64::from).map(i64::abs).iter().sum::<i64>()).max();
        let most = most.unwrap();
        assert!(255 * most * most + (1 << (2 * SUBPIXEL_BITS - 1)) <= i32::MAX.into(), "{most}");
    }
}
