//! The grids of belief propagation: strips of the picture, halved repeatedly.

use crate::{
    error::{Error, Result},
    image::Size,
};

/// A sentinel above any belief: the data cost of padding beyond the last disparity, which fills a word.
pub const FAR: u32 = 0xffff;

/// Most bytes of a strip's messages: the binding size that every device has. The limit does not depend on the device,
/// so that strips, which affect the result, are the same everywhere.
pub const MAX_MESSAGE_BYTES: u64 = 128 << 20;

/// Halo rows of a strip, above and below the rows that it decides.
pub const OVERLAP: u32 = 16;

/// A strip of rows of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strip {
    /// First row of the strip.
    pub first_row: u32,
    /// Number of rows.
    pub rows: u32,
}

/// The strips of a picture of `size` with `disparities` disparities, each with the rows that it decides; a single strip
/// if its messages take at most `bytes`.
///
/// # Errors
/// [`Error::TooLarge`] if `bytes` does not hold three times [`OVERLAP`] rows.
pub fn strips(Size { width, height }: Size, disparities: u32, bytes: u64) -> Result<Vec<(Strip, Strip)>> {
    let row_bytes = 16 * u64::from(width) * u64::from(disparities.div_ceil(4));
    let most = bytes / row_bytes;
    if most >= height.into() {
        let whole = Strip { first_row: 0, rows: height };
        return Ok(vec![(whole, whole)]);
    }
    if most < u64::from(3 * OVERLAP) {
        return Err(Error::TooLarge {
            what: format!(
                "belief propagation in {} rows of a picture {width} px wide with {disparities} disparities",
                3 * OVERLAP
            ),
            needed: row_bytes * u64::from(3 * OVERLAP),
            limit: bytes,
            way_out: "search fewer disparities, scale the pictures down, or use the method hsad".into(),
        });
    }
    let step = most as u32 - 2 * OVERLAP;
    let strip = |first: u32| {
        let decided = Strip { first_row: first, rows: step.min(height - first) };
        let begin = first.saturating_sub(OVERLAP);
        let end = (first + decided.rows + OVERLAP).min(height);
        (Strip { first_row: begin, rows: end - begin }, decided)
    };
    Ok((0..height).step_by(step as usize).map(strip).collect())
}

/// The sizes of a strip's grids, finest first: each half the previous one, rounded up.
pub fn levels(size: Size, count: u32) -> Vec<Size> {
    let sizes = std::iter::successors(Some(size), |&Size { width, height }| {
        (width.max(height) > 1).then_some(Size::new(width.div_ceil(2), height.div_ceil(2)))
    });
    sizes.take(count as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_decide_each_row_once_and_see_beyond() {
        let row = 16 * 10 * 2;
        assert_eq!(strips(Size::new(10, 200), 7, 200 * row).unwrap().len(), 1);
        for most in [48, 50, 120, 199] {
            let mut next = 0;
            for (seen, decided) in strips(Size::new(10, 200), 7, most * row).unwrap() {
                assert_eq!(decided.first_row, next);
                next += decided.rows;
                assert!(u64::from(seen.rows) <= most && decided.rows > 0);
                assert_eq!(seen.first_row, decided.first_row.saturating_sub(OVERLAP));
                assert_eq!(seen.first_row + seen.rows, (next + OVERLAP).min(200));
            }
            assert_eq!(next, 200);
        }
        let error = strips(Size::new(10, 200), 7, 47 * row).unwrap_err().to_string();
        assert!(error.contains("48 rows") && error.contains("search fewer disparities"), "{error}");
    }

    #[test]
    fn grids_are_halved_down_to_one_node() {
        assert_eq!(levels(Size::new(5, 3), 9), [Size::new(5, 3), Size::new(3, 2), Size::new(2, 1), Size::new(1, 1)]);
        assert_eq!(levels(Size::new(5, 3), 2), [Size::new(5, 3), Size::new(3, 2)]);
        assert_eq!(levels(Size::new(1, 1), 5), [Size::new(1, 1)]);
    }
}
