//! Occlusions: part of the picture is hidden, nothing moves.

use super::random::Random;
use crate::{
    image::{Plane, Size},
    io::Picture,
};

/// Side of a patch as a fraction of the picture's shorter side: a 24th to an 8th.
const PATCH: [u32; 2] = [24, 8];
/// Side of the single-coloured cells of a patch, in pixels.
const CELL: u32 = 4;

/// Draws rectangles of random colours at random positions until they hide `share` (0 to 1) of the picture. Returns the
/// picture and a mask, 255 where the original is visible.
///
/// The cells of 4x4 px have interest points of their own, which correspond to nothing.
pub(super) fn clutter(picture: &Picture, share: f64, mut random: Random) -> (Picture, Plane<u8>) {
    let Size { width, height } = picture.size();
    let mut changed = picture.clone();
    let mut visible = Plane::filled((width, height), 255);
    let [least, most] = PATCH.map(|part| (width.min(height) / part).max(1));
    let target = (share * f64::from(width) * f64::from(height)).round() as usize;
    let mut hidden = 0;
    while hidden < target {
        let [patch_width, patch_height] = [(); 2].map(|()| least + random.below(most - least + 1));
        let left = random.below(width - patch_width + 1);
        let top = random.below(height - patch_height + 1);
        let columns = patch_width.div_ceil(CELL);
        let colours: Vec<u64> = (0..columns * patch_height.div_ceil(CELL)).map(|_| random.next()).collect();
        for y in 0..patch_height {
            for x in 0..patch_width {
                let [red, green, blue, ..] = colours[(y / CELL * columns + x / CELL) as usize].to_le_bytes();
                changed.set(left + x, top + y, [red, green, blue, 255]);
                hidden += usize::from(visible.get(left + x, top + y) == 255);
                visible.set(left + x, top + y, 0);
            }
        }
    }
    (changed, visible)
}

/// Draws a frame of one colour that hides half of `share` of the width or height on each side. Returns the picture and
/// a mask, 255 where the original is visible.
pub(super) fn frame(picture: &Picture, share: f64, fill: [u8; 4]) -> (Picture, Plane<u8>) {
    let Size { width, height } = picture.size();
    let strip = |side: u32| (share / 2.0 * f64::from(side)).round() as u32;
    let (across, down) = (strip(width), strip(height));
    let inside = |x: u32, y: u32| x >= across && x < width - across && y >= down && y < height - down;
    let changed = Picture::from_fn((width, height), |x, y| if inside(x, y) { picture.get(x, y) } else { fill });
    (changed, Plane::from_fn((width, height), |x, y| if inside(x, y) { 255 } else { 0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clutter_hides_the_share_and_changes_nothing_else() {
        let picture = Picture::from_fn((200, 100), |x, y| [x as u8, y as u8, 0, 255]);
        let (changed, visible) = clutter(&picture, 0.3, Random::new(5, 0));
        let hidden = visible.data().iter().filter(|&&v| v == 0).count();
        // At most one patch too many is hidden: 12x12 px.
        assert!((6000..6144).contains(&hidden), "{hidden}");
        for ((before, after), &visible) in picture.data().iter().zip(changed.data()).zip(visible.data()) {
            assert!(visible == 0 || before == after);
        }
        let (tiny, visible) = clutter(&Picture::filled((1, 1), [1; 4]), 1.0, Random::new(5, 0));
        assert!(tiny.get(0, 0) != [1; 4] && visible.get(0, 0) == 0);
    }

    #[test]
    fn a_frame_by_hand() {
        let picture = Picture::filled((10, 6), [1, 2, 3, 255]);
        let (changed, visible) = frame(&picture, 0.4, [9; 4]);
        let shown: Vec<(u32, u32)> =
            (0..6).flat_map(|y| (0..10).map(move |x| (x, y))).filter(|&(x, y)| visible.get(x, y) == 255).collect();
        // The frame is 2 of 10 columns wide and 1.2 of 6 rows high on each side.
        assert_eq!((shown.len(), shown[0], shown[23]), (24, (2, 1), (7, 4)));
        assert_eq!((changed.get(2, 1), changed.get(1, 1)), ([1, 2, 3, 255], [9; 4]));
    }
}
