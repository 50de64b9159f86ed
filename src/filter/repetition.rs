//! Pictures that were enlarged without interpolation, by repeating pixels.

use crate::image::{Luma, Size};

/// Smallest share of the pixels beside a line between blocks that differ across the line, 0 to 1; other lines have less.
const DIFFERENT: f32 = 0.01;
/// Smallest number of lines between blocks that tell.
const SMALLEST: usize = 16;

/// The whole factor, rounded down, by which a view was enlarged without interpolation, as a nearest-neighbour enlargement repeats each
/// pixel in its row and in its column; 1 for any other view. A compression with losses hides it.
pub fn repetition(view: &Luma) -> u32 {
    let Size { width, height } = view.size();
    let columns = (1..width).filter(|&x| {
        let different = (0..height).filter(|&y| view.get(x, y) != view.get(x - 1, y)).count();
        different as f32 > DIFFERENT * height as f32
    });
    let rows = (1..height).filter(|&y| {
        let different = (0..width).filter(|&x| view.get(x, y) != view.get(x, y - 1)).count();
        different as f32 > DIFFERENT * width as f32
    });
    least_distance(&columns.collect::<Vec<_>>()).min(least_distance(&rows.collect::<Vec<_>>()))
}

/// The least distance between lines in order; 1 for a few lines.
fn least_distance(lines: &[u32]) -> u32 {
    let distances = lines.windows(2).map(|pair| pair[1] - pair[0]);
    distances.min().filter(|_| lines.len() >= SMALLEST).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(x: u32, y: u32) -> u8 {
        ((x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).rotate_left(9) >> 24) as u8
    }

    #[test]
    fn repeated_pixels_are_counted() {
        // Blocks need not begin at the edge, nor be of one size.
        let enlarged = |across: f32, down: f32| {
            Luma::from_fn((200, 150), |x, y| texture(((x + 1) as f32 / across) as u32, ((y + 2) as f32 / down) as u32))
        };
        for factor in [1.0, 2.0, 3.0, 6.0, 7.3, 8.0] {
            assert_eq!(repetition(&enlarged(factor, factor)), factor as u32, "{factor}");
        }
        // Along one axis only, as in an interlaced picture; too few blocks to tell; nothing to tell from.
        assert_eq!(
            [enlarged(1.0, 2.0), enlarged(2.0, 1.0), enlarged(16.0, 16.0)].map(|view| repetition(&view)),
            [1; 3]
        );
        assert_eq!(repetition(&Luma::filled((200, 150), 90)), 1);
    }

    #[test]
    fn a_few_other_changes_do_not_matter() {
        // Changes everywhere in one of 200 rows, and in ten of them.
        let disturbed = |rows: u32| {
            Luma::from_fn((120, 200), |x, y| if y % rows == 7 { texture(x, y) } else { texture(x / 6, y / 6) })
        };
        assert_eq!(repetition(&disturbed(20)), 1);
        let in_one_column = Luma::from_fn((120, 200), |x, y| texture(x / 6, y / 6) ^ u8::from((x, y) == (62, 7)));
        assert_eq!(repetition(&in_one_column), 6);
    }
}
