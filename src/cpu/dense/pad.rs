//! Padding, from the definition.

use crate::{
    dense::{Brightness, kernels::PadParams},
    image::Luma,
};

/// The output of the padding kernel after a change of brightness, from the beginning of the buffer; words before
/// `params.offset`, which the kernel does not write, are 0.
pub fn pad(luma: &Luma, params: &PadParams, brightness: Brightness) -> Vec<u32> {
    let mut words = vec![0; params.offset as usize];
    for row in i64::from(params.first_row)..i64::from(params.first_row) + i64::from(params.rows) {
        for word in 0..i64::from(params.stride) {
            let column = 4 * (i64::from(params.first_word) + word);
            words.push(u32::from_le_bytes([0, 1, 2, 3].map(|i| brightness.apply(luma.get_clamped(column + i, row)))));
        }
    }
    words
}
