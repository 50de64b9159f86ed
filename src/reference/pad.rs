//! Padding, from the definition.

use crate::{dense::PadParams, image::Luma};

/// The words that the padding kernel writes, from the beginning of the buffer; those before
/// `params.offset`, which it leaves alone, are 0.
pub fn padded(luma: &Luma, params: &PadParams) -> Vec<u32> {
    let pixel = |column: i64, row: i64| {
        let x = if params.mirrored == 1 { i64::from(luma.width()) - 1 - column } else { column };
        luma.get_clamped(x, row)
    };
    let mut words = vec![0; params.offset as usize];
    for row in i64::from(params.first_row)..i64::from(params.first_row) + i64::from(params.rows) {
        for word in 0..i64::from(params.stride) {
            let column = i64::from(params.first_column) + 4 * word;
            words.push(u32::from_le_bytes([0, 1, 2, 3].map(|i| pixel(column + i, row))));
        }
    }
    words
}
