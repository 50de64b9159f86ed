//! Haar wavelet responses at sub-pixel positions and sizes, exact in integers.

use crate::reference::integral::IntegralImage;

/// A length in 1/16 px, to the nearest.
fn sixteenths(pixels: f32) -> i32 {
    (pixels * 16.0 + 0.5).floor() as i32
}

/// The Haar wavelet responses `(dx, dy)` at `(x, y)`, divided by the area of a quarter of the wavelet
/// so that they compare across sizes.
///
/// The wavelet is a square of side `2 * half` around `(x, y)`: right half minus left half, lower
/// half minus upper half. Beyond the picture everything is 0.
pub fn responses(integral: &IntegralImage, x: f32, y: f32, half: f32) -> (f32, f32) {
    // The centre of pixel 0 lies half a pixel from the picture's corner.
    let (x, y) = (sixteenths(x) + 8, sixteenths(y) + 8);
    let half = sixteenths(half);
    let (dx, dy) = exact_responses(integral, x, y, half);
    let quarter = (half * half) as f32;
    (dx as f32 / quarter, dy as f32 / quarter)
}

/// As [`responses`], not divided: 256 times the difference of the halves' sums. All lengths in
/// 1/16 px from the picture's top left corner.
pub fn exact_responses(integral: &IntegralImage, x: i32, y: i32, half: i32) -> (i32, i32) {
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
    fn a_step_is_seen_across_and_not_along() {
        let step = IntegralImage::new(&Luma::from_fn(16, 16, |x, _| if x < 8 { 10 } else { 110 }));
        // The edge lies between the centres of pixels 7 and 8; two quarters of the wavelet on each side.
        assert_eq!(responses(&step, 7.5, 7.5, 3.0), (200.0, 0.0));
        let lying = IntegralImage::new(&Luma::from_fn(16, 16, |_, y| if y < 8 { 10 } else { 110 }));
        assert_eq!(responses(&lying, 7.5, 7.5, 3.0), (0.0, 200.0));
    }

    #[test]
    fn parts_of_pixels_count() {
        let step = IntegralImage::new(&Luma::from_fn(16, 16, |x, _| if x < 8 { 0 } else { 16 }));
        // Half a pixel to the right the left half reaches half a pixel over the edge: of 2 px each,
        // right 2 * 16, left 0.5 * 16, times 4 rows; halves' difference 4 * 24 of 4 px in a quarter.
        assert_eq!(responses(&step, 8.0, 7.5, 2.0), (24.0, 0.0));
        // 256 * 16 grey levels * (1/16 px)^2: the smallest wavelet just right of the edge sees nothing
        // but its left half lose to white beyond the edge.
        assert_eq!(exact_responses(&step, 128, 128, 1), (16 * 2, 0));
    }

    #[test]
    fn a_ramp_has_its_slope_everywhere() {
        let ramp = IntegralImage::new(&Luma::from_fn(64, 64, |x, y| (2 * x + y) as u8));
        // At whole and half pixels the sums of a stepped ramp are those of the smooth one.
        for (x, y) in [(30.0, 20.0), (30.5, 20.0), (31.5, 33.5)] {
            // Halves of 4 x 8 px whose centres are 4 px apart: 4 * slope * 32 px over 16 px.
            assert_eq!(responses(&ramp, x, y, 4.0).0, 16.0);
        }
    }

    #[test]
    fn flat_is_nothing_inside_and_wrapped_sums_do_no_harm() {
        let white = IntegralImage::new(&Luma::filled(6000, 4000, 255));
        assert_eq!(exact_responses(&white, 16 * 5000 + 3, 16 * 3500 + 5, 16 * 90 + 7), (0, 0));
    }
}
