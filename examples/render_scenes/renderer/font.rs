//! Capital letters and digits of 5 x 7 dots.

/// Rows from the top, the leftmost dot in bit 4.
const GLYPHS: [(char, [u8; 7]); 36] = [
    ('A', [14, 17, 17, 31, 17, 17, 17]),
    ('B', [30, 17, 17, 30, 17, 17, 30]),
    ('C', [14, 17, 16, 16, 16, 17, 14]),
    ('D', [30, 17, 17, 17, 17, 17, 30]),
    ('E', [31, 16, 16, 30, 16, 16, 31]),
    ('F', [31, 16, 16, 30, 16, 16, 16]),
    ('G', [14, 17, 16, 23, 17, 17, 15]),
    ('H', [17, 17, 17, 31, 17, 17, 17]),
    ('I', [14, 4, 4, 4, 4, 4, 14]),
    ('J', [7, 2, 2, 2, 2, 18, 12]),
    ('K', [17, 18, 20, 24, 20, 18, 17]),
    ('L', [16, 16, 16, 16, 16, 16, 31]),
    ('M', [17, 27, 21, 21, 17, 17, 17]),
    ('N', [17, 25, 21, 19, 17, 17, 17]),
    ('O', [14, 17, 17, 17, 17, 17, 14]),
    ('P', [30, 17, 17, 30, 16, 16, 16]),
    ('Q', [14, 17, 17, 17, 21, 18, 13]),
    ('R', [30, 17, 17, 30, 20, 18, 17]),
    ('S', [15, 16, 16, 14, 1, 1, 30]),
    ('T', [31, 4, 4, 4, 4, 4, 4]),
    ('U', [17, 17, 17, 17, 17, 17, 14]),
    ('V', [17, 17, 17, 17, 17, 10, 4]),
    ('W', [17, 17, 17, 21, 21, 27, 17]),
    ('X', [17, 17, 10, 4, 10, 17, 17]),
    ('Y', [17, 17, 10, 4, 4, 4, 4]),
    ('Z', [31, 1, 2, 4, 8, 16, 31]),
    ('0', [14, 17, 19, 21, 25, 17, 14]),
    ('1', [4, 12, 4, 4, 4, 4, 14]),
    ('2', [14, 17, 1, 6, 8, 16, 31]),
    ('3', [30, 1, 1, 14, 1, 1, 30]),
    ('4', [2, 6, 10, 18, 31, 2, 2]),
    ('5', [31, 16, 30, 1, 1, 17, 14]),
    ('6', [6, 8, 16, 30, 17, 17, 14]),
    ('7', [31, 1, 2, 4, 8, 8, 8]),
    ('8', [14, 17, 17, 14, 17, 17, 14]),
    ('9', [14, 17, 17, 15, 1, 2, 12]),
];

/// Columns from one character to the next.
const ADVANCE: f64 = 6.0;

/// Whether there is ink at (u, v) of a line of text, centred on the origin, `height` high, v upwards.
pub fn ink(text: &str, height: f64, u: f64, v: f64) -> bool {
    let dot = height / 7.0;
    let column = u / dot + (text.len() as f64 * ADVANCE - 1.0) / 2.0;
    let row = 3.5 - v / dot;
    if column < 0.0 || !(0.0..7.0).contains(&row) {
        return false;
    }
    text.chars().nth((column / ADVANCE) as usize).is_some_and(|c| dotted(c, column % ADVANCE, row))
}

/// Whether there is ink at a column and row of the `index`-th glyph: for text that only has to look like text.
pub fn any_ink(index: u32, column: f64, row: f64) -> bool {
    dotted(GLYPHS[index as usize % 26].0, column, row)
}

fn dotted(c: char, column: f64, row: f64) -> bool {
    let glyph = GLYPHS.iter().find(|(letter, _)| *letter == c);
    column < 5.0 && glyph.is_some_and(|(_, rows)| rows[row as usize] >> (4 - column as usize) & 1 == 1)
}
