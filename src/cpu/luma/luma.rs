//! Colour to luma.

use crate::{
    error::{Error, Result},
    image::{Luma, luma_of},
};

/// Converts `width * height` RGBA pixels, four bytes each, to luma; alpha is ignored.
///
/// # Errors
/// [`Error::Parameter`] if a side is 0 or the number of bytes does not fit.
pub fn luma(width: u32, height: u32, rgba: &[u8]) -> Result<Luma> {
    let (pixels, rest) = rgba.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(Error::Parameter {
            name: "picture",
            value: format!("{} bytes", rgba.len()),
            expected: "RGBA takes four bytes per pixel".into(),
        });
    }
    Luma::new((width, height), pixels.iter().map(|&[r, g, b, _]| luma_of([r, g, b])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primaries_and_greys() {
        let rgba = [[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 255, 9], [255, 255, 255, 0], [37, 37, 37, 255]];
        let luma = luma(5, 1, rgba.as_flattened()).unwrap();
        // 77*255 = 19635, +128 = 19763, /256 = 77.2; 38250 -> 149.9; 7395 -> 29.4
        assert_eq!(luma.data(), [77, 149, 29, 255, 37]);
    }

    #[test]
    fn a_wrong_number_of_bytes_is_refused() {
        assert!(luma(1, 1, &[1, 2, 3]).is_err());
        assert!(luma(2, 1, &[1, 2, 3, 4]).is_err());
    }
}
