//! The integral image: the sum of any box in four look-ups (Crow, 'Summed-Area Tables for Texture Mapping', SIGGRAPH
//! 1984; Viola and Jones, CVPR 2001).

use crate::{
    cpu::features::{integral_columns::integral_columns, integral_rows::integral_rows},
    image::{Luma, Plane},
};

/// The sums of luma over all pixels above and to the left.
///
/// Sums wrap at 2^32. A difference of wrapped sums is right whenever the box's own sum fits in 32 bits, so that the
/// size of pictures is not limited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IntegralImage {
    /// Sums, one column and one row larger than the picture; column 0 and row 0 are 0.
    sums: Plane<u32>,
}

impl IntegralImage {
    /// The integral image of `luma`.
    pub fn new(luma: &Luma) -> Self {
        let mut sums = integral_rows(luma);
        integral_columns(&mut sums);
        Self { sums }
    }

    /// Width of the picture, in pixels.
    pub fn width(&self) -> u32 {
        self.sums.width() - 1
    }

    /// Height of the picture, in pixels.
    pub fn height(&self) -> u32 {
        self.sums.height() - 1
    }

    /// All sums: `(x, y)` holds the sum of luma over columns below `x` and rows below `y`, modulo 2^32.
    pub fn sums(&self) -> &Plane<u32> {
        &self.sums
    }

    /// The sum of luma over `x0 <= x < x1`, `y0 <= y < y1`, modulo 2^32.
    pub fn box_sum(&self, x0: u32, y0: u32, x1: u32, y1: u32) -> u32 {
        let (top, bottom) = (self.sums.row(y0), self.sums.row(y1));
        let (x0, x1) = (x0 as usize, x1 as usize);
        bottom[x1].wrapping_sub(top[x1]).wrapping_sub(bottom[x0]).wrapping_add(top[x0])
    }

    /// 256 times the integral of the picture, as unit squares of luma, over everything above and
    /// to the left of `(x, y)`, modulo 2^32.
    ///
    /// `x` and `y` are in 1/16 px from the picture's top left corner (pixel `p` spans `16 p` to
    /// `16 p + 16`) and are clamped to the picture. Within a pixel the integral is bilinear, so
    /// this is exact, not an approximation.
    pub fn at_sixteenths(&self, x: i32, y: i32) -> u32 {
        let x = x.clamp(0, self.width() as i32 * 16) as u32;
        let y = y.clamp(0, self.height() as i32 * 16) as u32;
        let (column, row) = ((x / 16) as usize, y / 16);
        let (fx, fy) = (x % 16, y % 16);
        let (next_column, next_row) = ((column + 1).min(self.width() as usize), (row + 1).min(self.height()));
        let across = |row: &[u32]| row[column].wrapping_mul(16 - fx).wrapping_add(row[next_column].wrapping_mul(fx));
        let (top, bottom) = (across(self.sums.row(row)), across(self.sums.row(next_row)));
        top.wrapping_mul(16 - fy).wrapping_add(bottom.wrapping_mul(fy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_by_two() -> IntegralImage {
        IntegralImage::new(&Luma::new((3, 2), vec![1, 2, 3, 4, 5, 6]).unwrap())
    }

    #[test]
    fn sums_of_three_by_two() {
        assert_eq!(three_by_two().sums().data(), [0, 0, 0, 0, 0, 1, 3, 6, 0, 5, 12, 21]);
    }

    #[test]
    fn boxes_of_three_by_two() {
        let integral = three_by_two();
        assert_eq!(integral.box_sum(0, 0, 3, 2), 21);
        assert_eq!(integral.box_sum(1, 1, 3, 2), 11);
        assert_eq!(integral.box_sum(2, 0, 3, 1), 3);
        assert_eq!(integral.box_sum(1, 1, 1, 2), 0);
    }

    #[test]
    fn between_pixels_the_integral_counts_parts_of_pixels() {
        let integral = three_by_two();
        // One and a half columns, half a row: (1 + 2 / 2) / 2 = 1.
        assert_eq!(integral.at_sixteenths(24, 8), 256);
        // A quarter of the first pixel's width and an eighth of its height: 1 / 32.
        assert_eq!(integral.at_sixteenths(4, 2), 8);
        // One whole row and half of the second, all columns: 6 + 15 / 2.
        assert_eq!(integral.at_sixteenths(48, 24), 3456);
    }

    #[test]
    fn beyond_the_picture_there_is_nothing_to_add() {
        let integral = three_by_two();
        assert_eq!(integral.at_sixteenths(-5, 20), 0);
        assert_eq!(integral.at_sixteenths(1000, 1000), 21 * 256);
    }

    /// 24 megapixels of white sum to 6.12e9, beyond 2^32.
    #[test]
    fn boxes_are_exact_though_the_sums_wrap() {
        let integral = IntegralImage::new(&Luma::filled((6000, 4000), 255));
        assert_eq!(integral.sums().get(6000, 4000), (6_120_000_000u64 % (1 << 32)) as u32);
        assert_eq!(integral.box_sum(0, 2700, 6000, 2900), 6000 * 200 * 255);
        for (x, y) in [(0, 0), (5613, 3613), (3000, 2807), (5000, 3300)] {
            assert_eq!(integral.box_sum(x, y, x + 387, y + 387), 387 * 387 * 255);
        }
    }
}
