//! Haar wavelet responses at sub-pixel positions and sizes, exact in integers.

use crate::cpu::features::integral::IntegralImage;

/// Position and scale of an interest point, rounded once to 1/16 px, so that all devices sample the same pixels around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuantizedPoint {
    /// Distance from the left edge of the picture, in 1/16 px.
    pub x: i32,
    /// Distance from the top edge of the picture, in 1/16 px.
    pub y: i32,
    /// Scale, in 1/16 px.
    pub scale: i32,
}

impl QuantizedPoint {
    /// The quantized point at `(x, y)` pixels, where the centre of the first pixel is `(0, 0)`.
    pub fn new(x: f32, y: f32, scale: f32) -> Self {
        let sixteenths = |pixels: f32| (pixels * 16.0 + 0.5).floor() as i32;
        Self { x: sixteenths(x) + 8, y: sixteenths(y) + 8, scale: sixteenths(scale) }
    }
}

/// The Haar wavelet responses `(dx, dy)` at `(x, y)`, times 256: right half minus left half, lower half
/// minus upper half of a square of side `2 * half`.
///
/// All lengths are in 1/16 px, positions from the top left corner of the picture. Outside the picture luma is 0. Exact
/// for a `half` below 128 px.
pub fn responses(integral: &IntegralImage, x: i32, y: i32, half: i32) -> (i32, i32) {
    let at = |dx: i32, dy: i32| integral.at_sixteenths(x + dx * half, y + dy * half);
    let [top_left, top, top_right] = [at(-1, -1), at(0, -1), at(1, -1)];
    let [left, right] = [at(-1, 0), at(1, 0)];
    let [bottom_left, bottom, bottom_right] = [at(-1, 1), at(0, 1), at(1, 1)];
    let area =
        |from: u32, to: u32, right: u32, below: u32| to.wrapping_sub(right).wrapping_sub(below).wrapping_add(from);
    let right_half = area(top, bottom_right, top_right, bottom);
    let left_half = area(top_left, bottom, top, bottom_left);
    let lower_half = area(left, bottom_right, right, bottom_left);
    let upper_half = area(top_left, right, top_right, left);
    (right_half.wrapping_sub(left_half) as i32, lower_half.wrapping_sub(upper_half) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Luma;

    #[test]
    fn places_are_rounded_to_sixteenths_from_the_corner() {
        assert_eq!(QuantizedPoint::new(0.0, 10.0, 1.2), QuantizedPoint { x: 8, y: 168, scale: 19 });
        assert_eq!(QuantizedPoint::new(2.53125, 2.53124, 2.0), QuantizedPoint { x: 49, y: 48, scale: 32 });
    }

    #[test]
    fn a_step_is_seen_across_and_not_along() {
        let step = IntegralImage::new(&Luma::from_fn((16, 16), |x, _| if x < 8 { 10 } else { 110 }));
        // Halves of 3 x 6 px that differ by 100.
        assert_eq!(responses(&step, 8 * 16, 8 * 16, 3 * 16), (256 * 1800, 0));
        let lying = IntegralImage::new(&Luma::from_fn((16, 16), |_, y| if y < 8 { 10 } else { 110 }));
        assert_eq!(responses(&lying, 8 * 16, 8 * 16, 3 * 16), (0, 256 * 1800));
    }

    #[test]
    fn parts_of_pixels_count() {
        let step = IntegralImage::new(&Luma::from_fn((16, 16), |x, _| if x < 8 { 0 } else { 16 }));
        // Half a pixel right of the edge: the right half sees 2 px of light, the left half 0.5, in 4 rows.
        assert_eq!(responses(&step, 8 * 16 + 8, 8 * 16, 2 * 16), (256 * 16 * 6, 0));
        // The smallest wavelet, on the edge: 1/16 px by 1/8 px of light.
        assert_eq!(responses(&step, 8 * 16, 8 * 16, 1), (16 * 2, 0));
    }

    #[test]
    fn a_ramp_has_its_slope_everywhere() {
        let ramp = IntegralImage::new(&Luma::from_fn((64, 64), |x, y| (2 * x + y) as u8));
        // At whole and half pixels the sums of a stepped ramp equal those of a smooth one: halves of 4 x 8 px whose
        // centres are 4 px apart.
        for (x, y) in [(30 * 16 + 8, 20 * 16), (30 * 16, 20 * 16 + 8), (31 * 16, 33 * 16)] {
            assert_eq!(responses(&ramp, x, y, 4 * 16), (256 * 2 * 4 * 32, 256 * 4 * 32));
        }
    }

    #[test]
    fn beyond_the_picture_everything_is_zero() {
        let white = IntegralImage::new(&Luma::filled((8, 8), 255));
        // On the left edge the left half is outside the picture.
        assert_eq!(responses(&white, 0, 4 * 16, 2 * 16), (256 * 255 * 8, 0));
        assert_eq!(responses(&white, -100 * 16, 4 * 16, 2 * 16), (0, 0));
    }

    #[test]
    fn wrapped_sums_do_no_harm() {
        let white = IntegralImage::new(&Luma::filled((6000, 4000), 255));
        assert_eq!(responses(&white, 16 * 5000 + 3, 16 * 3500 + 5, 16 * 90 + 7), (0, 0));
        assert_eq!(responses(&white, 16 * 6000, 16 * 3500, 16 * 90), (-256 * 255 * 90 * 180, 0));
    }
}
