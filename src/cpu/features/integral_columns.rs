//! The second pass of the integral image: sums along columns.

use crate::image::Plane;

/// Adds to each value all values above it, modulo 2^32.
pub fn integral_columns(sums: &mut Plane<u32>) {
    let stride = sums.width() as usize;
    let values = sums.data_mut();
    for below in stride..values.len() {
        values[below] = values[below].wrapping_add(values[below - stride]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_wrap() {
        let mut sums = Plane::new((2, 3), vec![1, u32::MAX, 2, 3, 4, 5]).unwrap();
        integral_columns(&mut sums);
        assert_eq!(sums.data(), [1, u32::MAX, 3, 2, 7, 7]);
    }
}
