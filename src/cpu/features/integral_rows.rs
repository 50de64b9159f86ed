//! The first pass of the integral image: sums along rows.

use crate::image::{Luma, Plane};

/// The row sums of luma: `(x, y)` holds the sum of row `y - 1` over columns below `x`, modulo 2^32. The plane has one
/// column and one row more than the picture; column 0 and row 0 are 0.
pub fn integral_rows(luma: &Luma) -> Plane<u32> {
    let mut sums = Plane::filled((luma.width() + 1, luma.height() + 1), 0_u32);
    let stride = luma.width() as usize + 1;
    for (y, row) in (0..luma.height()).zip(sums.data_mut().chunks_mut(stride).skip(1)) {
        for (x, &value) in luma.row(y).iter().enumerate() {
            row[x + 1] = row[x].wrapping_add(u32::from(value));
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_by_two() {
        let luma = Luma::new((3, 2), vec![1, 2, 3, 4, 5, 6]).unwrap();
        assert_eq!(integral_rows(&luma).data(), [0, 0, 0, 0, 0, 1, 3, 6, 0, 4, 9, 15]);
    }
}
