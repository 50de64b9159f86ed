//! Things in front of the picture: nothing moves, and a part is hidden.

use super::random::Random;
use crate::{image::Plane, io::Picture};

/// Sides of a patch, by the shorter side of the picture: from a 24th to an 8th.
const PATCH: [u32; 2] = [24, 8];
/// Pixels on the side of a patch's cells, each of one colour.
const CELL: u32 = 4;

/// Rectangles of random colours at random places until they hide the `share` of the picture, and what they leave: 255.
///
/// Their cells of 4x4 px make interest points of their own, which correspond to nothing.
pub(super) fn clutter(picture: &Picture, share: f64, mut random: Random) -> (Picture, Plane<u8>) {
    let (width, height) = picture.size();
    let mut changed = picture.clone();
    let mut visible = Plane::filled(width, height, 255);
    let [least, most] = PATCH.map(|part| (width.min(height) / part).max(1));
    let wanted = (share * f64::from(width) * f64::from(height)).round() as usize;
    let mut hidden = 0;
    while hidden < wanted {
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

/// A frame of one colour: on each side it hides half the `share` of the width or height.
pub(super) fn frame(picture: &Picture, share: f64, fill: [u8; 4]) -> (Picture, Plane<u8>) {
    let (width, height) = picture.size();
    let strip = |side: u32| (share / 2.0 * f64::from(side)).round() as u32;
    let (across, down) = (strip(width), strip(height));
    let inside = |x: u32, y: u32| x >= across && x < width - across && y >= down && y < height - down;
    let changed = Picture::from_fn(width, height, |x, y| if inside(x, y) { picture.get(x, y) } else { fill });
    (changed, Plane::from_fn(width, height, |x, y| if inside(x, y) { 255 } else { 0 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clutter_hides_the_share_and_changes_nothing_else() {
        let picture = Picture::from_fn(200, 100, |x, y| [x as u8, y as u8, 0, 255]);
        let (changed, visible) = clutter(&picture, 0.3, Random::new(5, 0));
        let hidden = visible.data().iter().filter(|&&v| v == 0).count();
        // No more than the last patch too many: 12x12.
        assert!((6000..6144).contains(&hidden), "{hidden}");
        for ((before, after), &visible) in picture.data().iter().zip(changed.data()).zip(visible.data()) {
            assert!(visible == 0 || before == after);
        }
        let (tiny, visible) = clutter(&Picture::filled(1, 1, [1; 4]), 1.0, Random::new(5, 0));
        assert!(tiny.get(0, 0) != [1; 4] && visible.get(0, 0) == 0);
    }

    #[test]
    fn a_frame_by_hand() {
        let picture = Picture::filled(10, 6, [1, 2, 3, 255]);
        let (changed, visible) = frame(&picture, 0.4, [9; 4]);
        let shown: Vec<(u32, u32)> =
            (0..6).flat_map(|y| (0..10).map(move |x| (x, y))).filter(|&(x, y)| visible.get(x, y) == 255).collect();
        // 2 of 10 columns and 1.2 of 6 rows on each side.
        assert_eq!((shown.len(), shown[0], shown[23]), (24, (2, 1), (7, 4)));
        assert_eq!((changed.get(2, 1), changed.get(1, 1)), ([1, 2, 3, 255], [9; 4]));
    }
}
