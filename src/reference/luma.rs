//! Colour to luma, and the words in which luma travels.

use crate::{
    error::{Error, Result},
    image::Luma,
};

/// Luma of a picture of `width * height` RGBA bytes; alpha is ignored.
///
/// # Errors
/// [`Error::Parameter`] if a side is 0 or the number of bytes does not fit.
pub fn from_rgba(width: u32, height: u32, rgba: &[u8]) -> Result<Luma> {
    let (pixels, rest) = rgba.as_chunks::<4>();
    if !rest.is_empty() {
        return Err(Error::Parameter {
            name: "picture",
            value: format!("{} bytes", rgba.len()),
            expected: "RGBA takes four bytes a pixel".into(),
        });
    }
    Luma::new(width, height, pixels.iter().map(|&[r, g, b, _]| weigh(r, g, b)).collect())
}

/// The weights of Rec. 601 in 1/256, rounded; they sum to 256, so that grey stays what it is.
fn weigh(r: u8, g: u8, b: u8) -> u8 {
    ((77 * u32::from(r) + 150 * u32::from(g) + 29 * u32::from(b) + 128) >> 8) as u8
}

/// The words of packed luma: each row starts a word, pixel `x` is byte `x % 4` of its row's word
/// `x / 4`, lowest byte first, and what is left of a row's last word is 0.
pub fn pack(luma: &Luma) -> Vec<u32> {
    let word = |pixels: &[u8]| pixels.iter().rev().fold(0, |word, &pixel| word << 8 | u32::from(pixel));
    (0..luma.height()).flat_map(|y| luma.row(y).chunks(4).map(word)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primaries_and_greys() {
        let rgba = [[255, 0, 0, 9], [0, 255, 0, 9], [0, 0, 255, 9], [255, 255, 255, 0], [37, 37, 37, 255]];
        let luma = from_rgba(5, 1, rgba.as_flattened()).unwrap();
        // 77*255 = 19635, +128 = 19763, /256 = 77.2; 38250 -> 149.9; 7395 -> 29.4
        assert_eq!(luma.data(), [77, 149, 29, 255, 37]);
    }

    #[test]
    fn a_wrong_number_of_bytes_is_refused() {
        assert!(from_rgba(1, 1, &[1, 2, 3]).is_err());
        assert!(from_rgba(2, 1, &[1, 2, 3, 4]).is_err());
    }

    #[test]
    fn rows_start_words_and_are_padded_with_zeros() {
        let luma = Luma::new(5, 2, vec![1, 2, 3, 4, 5, 6, 7, 8, 9, 10]).unwrap();
        assert_eq!(pack(&luma), [0x0403_0201, 0x05, 0x0908_0706, 0x0a]);
    }
}
