//! Luma of the scene from a mosaic.

use crate::{
    filter::in_parallel,
    image::{Luma, Size},
};

/// Units per grey value of the green plane.
const SCALE: i64 = 16;

/// The luma `(R + 2 G + B) / 4` at each pixel of a mosaic whose green pixels have the parity `green` of `x + y`. Red and
/// blue need not be told apart.
///
/// Green is interpolated along the direction of the smaller gradient, corrected by the second difference of the pixel's own
/// colour (Hamilton and Adams 1997, Adaptive color plane interpolation in single sensor color electronic camera, US patent
/// 5,629,734), but with weights in place of a choice. `R - G` and `B - G` are smoother than the colours: they are
/// interpolated over 3x3 pixels with binomial weights, which sum them up to `(R - G) / 4 + (B - G) / 4`. Beyond the edges the
/// mosaic is mirrored, which keeps its phase if no side is below 3 pixels.
pub fn luma_of_mosaic(mosaic: &Luma, green: u32) -> Luma {
    let greens = in_parallel(mosaic.size(), |x, y| {
        if (x + y) % 2 == green { SCALE * i64::from(mosaic.get(x, y)) } else { green_at(mosaic, x, y) }
    });
    let difference = |x: u32, y: u32| SCALE * i64::from(mosaic.get(x, y)) - greens.get(x, y);
    in_parallel(mosaic.size(), |x, y| {
        let mut sum = 0;
        for (j, weight_y) in [(-1, 1), (0, 2), (1, 1)] {
            for (i, weight_x) in [(-1, 1), (0, 2), (1, 1)] {
                let (x, y) = mirrored(mosaic.size(), x, y, (i, j));
                sum += weight_x * weight_y * difference(x, y);
            }
        }
        let luma = 16 * greens.get(x, y) + sum;
        rounded(luma, 16 * SCALE).clamp(0, 255) as u8
    })
}

/// Green at a red or blue pixel, in 1 / [`SCALE`] grey value.
fn green_at(mosaic: &Luma, x: u32, y: u32) -> i64 {
    // Four times green, and the gradient, along one direction.
    let along = |(i, j): (i64, i64)| {
        let at = |step: i64| {
            let (x, y) = mirrored(mosaic.size(), x, y, (step * i, step * j));
            i64::from(mosaic.get(x, y))
        };
        let second_difference = 2 * at(0) - at(-2) - at(2);
        let fourfold = 2 * (at(-1) + at(1)) + second_difference;
        (fourfold, (at(-1) - at(1)).abs() + second_difference.abs())
    };
    let [(green_x, gradient_x), (green_y, gradient_y)] = [along((1, 0)), along((0, 1))];
    // Weights in the inverse ratio of the squared gradients; 1 for gradients of 0.
    let [weight_x, weight_y] = [gradient_y, gradient_x].map(|other| (1 + other) * (1 + other));
    rounded(SCALE / 4 * (weight_x * green_x + weight_y * green_y), weight_x + weight_y)
}

/// Rounds `numerator / denominator` to the nearest integer, halves up.
fn rounded(numerator: i64, denominator: i64) -> i64 {
    (2 * numerator + denominator).div_euclid(2 * denominator)
}

/// The pixel at an offset of at most 2 from `(x, y)`, mirrored at the edge pixels.
fn mirrored(Size { width, height }: Size, x: u32, y: u32, (i, j): (i64, i64)) -> (u32, u32) {
    let mirror = |at: i64, side: u32| {
        let last = i64::from(side) - 1;
        (last - (last - at.abs()).abs()).clamp(0, last) as u32
    };
    (mirror(i64::from(x) + i, width), mirror(i64::from(y) + j, height))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mosaic of one colour, red at the pixels of the parities `red` of column and row.
    fn mosaic_of(size: (u32, u32), [r, g, b]: [u8; 3], red: (u32, u32)) -> Luma {
        Luma::from_fn(size, |x, y| match (x % 2 == red.0, y % 2 == red.1) {
            (true, true) => r,
            (false, false) => b,
            _ => g,
        })
    }

    #[test]
    fn one_colour_is_one_luma_up_to_the_edges() {
        for red in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let green = (red.0 + red.1 + 1) % 2;
            for size in [(4, 4), (5, 3), (3, 4)] {
                // (90 + 2 * 60 + 30) / 4
                let luma = luma_of_mosaic(&mosaic_of(size, [90, 60, 30], red), green);
                assert_eq!(luma, Luma::filled(size, 60), "{red:?}");
            }
            assert_eq!(luma_of_mosaic(&mosaic_of((6, 6), [255, 0, 0], red), green), Luma::filled((6, 6), 64));
        }
    }

    #[test]
    fn an_edge_of_grey_stays_sharp() {
        for (across, down) in [(1, 0), (0, 1)] {
            let edge = Luma::from_fn((12, 12), |x, y| if across * x + down * y < 6 { 50 } else { 200 });
            for green in [0, 1] {
                assert_eq!(luma_of_mosaic(&edge, green), edge);
            }
        }
    }

    #[test]
    fn pictures_of_one_row_and_of_one_pixel() {
        for size in [(1, 1), (1, 5), (5, 1)] {
            assert_eq!(luma_of_mosaic(&Luma::filled(size, 77), 1), Luma::filled(size, 77));
        }
    }

    #[test]
    fn green_by_hand() {
        let column = |y: u32| [1, 5, 60, 9, 3][y as usize];
        let mosaic = Luma::from_fn((5, 5), |x, y| match (x, y) {
            (2, y) => column(y),
            (x, 2) => [40, 50, 60, 70, 80][x as usize],
            _ => 0,
        });
        // Along x: gradient 20 + 0, green (50 + 70) / 2 = 60. Along y: gradient 4 + 116, green 7 + 116 / 4 = 36.
        // Weights 121^2 and 21^2: (14641 * 60 + 441 * 36) / 15082 = 59.298, in sixteenths 948.8.
        assert_eq!(green_at(&mosaic, 2, 2), 949);
    }
}
