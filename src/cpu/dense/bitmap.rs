//! Bitmaps of the pixels that have a disparity, from the definition.

use crate::{
    dense::kernels::Bitmaps,
    disparity::{DisparityMap, NONE},
    image::{Luma, Size},
};

/// Which pixels have a disparity, 32 per word: rows in words of their own; then, for a shear of -1, 0 and 1 columns per
/// row and for each block of 32 rows, one word per column of the block's first row, from [`Bitmaps::MARGIN`] columns left
/// of the picture to as many right of it. Then the rows of the holes that `own`, the mask of the view, shows: it is 0 for a hidden pixel.
pub fn bitmaps(disparities: &DisparityMap, own: Option<&Luma>) -> Vec<u32> {
    let Size { width, height } = disparities.size();
    let is_inside = |x: i64, y: i64| (0..i64::from(width)).contains(&x) && (0..i64::from(height)).contains(&y);
    let known = |x: i64, y: i64| is_inside(x, y) && disparities.get(x as u32, y as u32) != NONE;
    let is_shown = |x: i64, y: i64| own.is_none_or(|mask| mask.get(x as u32, y as u32) != 0);
    let is_hole = |x: i64, y: i64| is_inside(x, y) && !known(x, y) && is_shown(x, y);
    let word = |bit: &dyn Fn(i64) -> bool| (0..32).fold(0, |word, j| word | u32::from(bit(j)) << j);
    let rows = || (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).step_by(32).map(move |x| (x, y)));
    let mut words: Vec<u32> = rows().map(|(x, y)| word(&|j| known(x + j, y))).collect();
    let margin = i64::from(Bitmaps::MARGIN);
    for shear in -1..=1 {
        for y in (0..i64::from(height)).step_by(32) {
            words.extend((-margin..i64::from(width) + margin).map(|x| word(&|j| known(x + shear * j, y + j))));
        }
    }
    words.extend(rows().map(|(x, y)| word(&|j| is_hole(x + j, y))));
    words
}
