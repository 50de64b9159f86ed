//! Padding, from the definition.

use crate::{
    dense::{Brightness, PadParams},
    image::Luma,
};

/// The words that the padding kernel writes after a change of brightness, from the beginning of the buffer; those
/// before `params.offset`, which it leaves alone, are 0.
pub fn padded(luma: &Luma, params: &PadParams, brightness: Brightness) -> Vec<u32> {
    let mut words = vec![0; params.offset as usize];
    for row in i64::from(params.first_row)..i64::from(params.first_row) + i64::from(params.rows) {
        for word in 0..i64::from(params.stride) {
            let column = 4 * (i64::from(params.first_word) + word);
            words.push(u32::from_le_bytes(
                [0, 1, 2, 3].map(|i| brightened(luma.get_clamped(column + i, row), brightness)),
            ));
        }
    }
    words
}

/// A luma after a change of brightness.
pub fn brightened(luma: u8, Brightness { gain, offset }: Brightness) -> u8 {
    ((gain * i32::from(luma) + offset + 128) >> 8).clamp(0, 255) as u8
}
