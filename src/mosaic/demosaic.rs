//! Luma of the scene from a mosaic.

use crate::{
    filter::in_parallel,
    image::{Luma, Size},
};

/// Units per grey value of the green plane.
const SCALE: i64 = 16;
/// Pixels that the interpolation reaches: 2 for green, 1 for its difference from red and blue.
const FRAME: u32 = 3;

/// The luma `(R + 2 G + B) / 4` at each pixel of a mosaic whose green pixels have the parity `green` of `x + y`. Red and
/// blue need not be told apart.
///
/// Green is interpolated along the direction of the smaller gradient, corrected by the second difference of the pixel's own
/// colour (Hamilton and Adams 1997, Adaptive color plane interpolation in single sensor color electronic camera, US patent
/// 5,629,734), but with weights in place of a choice. `R - G` and `B - G` are smoother than the colours: they are
/// interpolated over 3x3 pixels with binomial weights, which sum them up to `(R - G) / 4 + (B - G) / 4`. Beyond the edges the
/// mosaic is mirrored, which keeps its phase.
pub fn luma_of_mosaic(mosaic: &Luma, green: u32) -> Luma {
    let Size { width, height } = mosaic.size();
    let wide = mirrored(mosaic);
    // R - G or B - G, with a frame of 1 px.
    let differences = in_parallel(Size::new(width + 2, height + 2), |x, y| {
        let (wide_x, wide_y) = (x + FRAME - 1, y + FRAME - 1);
        let own = SCALE * i64::from(wide.get(wide_x, wide_y));
        if (x + y) % 2 == green { 0 } else { (own - green_at(&wide, wide_x, wide_y)) as i32 }
    });
    in_parallel(mosaic.size(), |x, y| {
        let rows = [y, y + 1, y + 2].map(|y| &differences.row(y)[x as usize..][..3]);
        let [above, own, below] = rows.map(|row| row[0] + 2 * row[1] + row[2]);
        let greens = SCALE * i64::from(mosaic.get(x, y)) - i64::from(rows[1][1]);
        let luma = 16 * greens + i64::from(above + 2 * own + below);
        rounded(luma, 16 * SCALE).clamp(0, 255) as u8
    })
}

/// Green at a red or blue pixel of a mosaic, in 1 / [`SCALE`] grey value.
fn green_at(mosaic: &Luma, x: u32, y: u32) -> i64 {
    let row = [x - 2, x - 1, x, x + 1, x + 2].map(|x| mosaic.get(x, y));
    let column = [y - 2, y - 1, y, y + 1, y + 2].map(|y| mosaic.get(x, y));
    let [(green_x, gradient_x), (green_y, gradient_y)] = [row, column].map(along);
    // Weights in the inverse ratio of the squared gradients; 1 for gradients of 0.
    let [weight_x, weight_y] = [gradient_y, gradient_x].map(|other| (1 + other) * (1 + other));
    rounded(SCALE / 4 * (weight_x * green_x + weight_y * green_y), weight_x + weight_y)
}

/// Four times green at the middle of five pixels, and the gradient there.
fn along(pixels: [u8; 5]) -> (i64, i64) {
    let pixels = pixels.map(i64::from);
    let second_difference = 2 * pixels[2] - pixels[0] - pixels[4];
    (2 * (pixels[1] + pixels[3]) + second_difference, (pixels[1] - pixels[3]).abs() + second_difference.abs())
}

/// Rounds `numerator / denominator` to the nearest integer, halves up.
fn rounded(numerator: i64, denominator: i64) -> i64 {
    (2 * numerator + denominator).div_euclid(2 * denominator)
}

/// The mosaic with a frame of [`FRAME`] px, mirrored at the edge pixels.
fn mirrored(mosaic: &Luma) -> Luma {
    let Size { width, height } = mosaic.size();
    let mirror = |at: u32, side: u32| {
        let period = i64::from(2 * (side - 1)).max(1);
        let place = (i64::from(at) - i64::from(FRAME)).rem_euclid(period);
        place.min(period - place) as u32
    };
    let columns: Vec<u32> = (0..width + 2 * FRAME).map(|x| mirror(x, width)).collect();
    let size = Size::new(width + 2 * FRAME, height + 2 * FRAME);
    Luma::from_fn(size, |x, y| mosaic.get(columns[x as usize], mirror(y, height)))
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
            for size in [(4, 4), (5, 3), (2, 2)] {
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
