//! What of a pair shows the scene.

use super::{config::View, kernels::Loss};
use crate::{
    disparity::DisparityRange,
    filter::in_parallel,
    image::{Luma, Size},
};

/// What does not show the scene in the dense matching of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'m> {
    /// Which pixels of the reference view and of the other one show the scene: 255 or 0; `None`: all do.
    pub masks: [Option<&'m Luma>; 2],
    /// What a pixel with a hidden partner loses before the refinement; after it the confidence.
    pub loss: Loss,
}

/// Pixels, in columns and in rows, to which surfaces are continued beyond what the other view shows. Farther away they are guesswork: the scene
/// Motorcycle turned by 30 degrees.
const CONTINUED: u32 = 32;

impl Seen<'_> {
    /// The mask of the reference view without the pixels more than 32 columns or rows away from any pixel with a partner which the other view
    /// shows at a disparity of `range`: nothing tells their disparity. `None` if the other view shows all.
    ///
    /// Beyond the edges of the other view its mask goes on.
    pub fn near_partners(&self, reference: View, range: DisparityRange) -> Option<Luma> {
        let [own, other] = self.masks;
        let other = other?;
        let ends = [range.min, range.last()].map(|disparity| reference.direction() * disparity);
        let far = CONTINUED.cast_signed();
        let reach = [ends[0].min(ends[1]) - far, ends[0].max(ends[1]) + far];
        let Size { width, height } = other.size();
        let column = |x: u32, step: i32| (i64::from(x) + i64::from(step)).clamp(0, i64::from(width) - 1) as usize;
        let shown = shown_before(other);
        Some(in_parallel(other.size(), |x, y| {
            let columns = [column(x, reach[0]), column(x, reach[1]) + 1];
            let rows = [y.saturating_sub(CONTINUED), height.min(y + CONTINUED + 1)].map(|row| &shown[row as usize]);
            let count = |row: &[u32]| row[columns[1]] - row[columns[0]];
            let is_near = count(rows[1]) > count(rows[0]);
            let own = own.map_or(u8::MAX, |mask| mask.get(x, y));
            if is_near { own } else { 0 }
        }))
    }
}

/// Numbers of shown pixels above each row and left of each column.
fn shown_before(mask: &Luma) -> Vec<Vec<u32>> {
    let mut counts = vec![vec![0; mask.width() as usize + 1]];
    for y in 0..mask.height() {
        let mut in_row = 0;
        let above = &counts[y as usize][1..];
        let row = mask.row(y).iter().zip(above).map(|(&value, &above)| {
            in_row += u32::from(value != 0);
            above + in_row
        });
        let row = std::iter::once(0).chain(row).collect();
        counts.push(row);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_far_from_any_partner_are_hidden() {
        let seen = |own, other| Seen { masks: [own, other], loss: Loss::Nothing };
        let range = |min, count| DisparityRange::new(min, count).unwrap();
        // The other view shows a pixel.
        let other = Luma::from_fn((200, 100), |x, y| if (x, y) == (100, 40) { 255 } else { 0 });
        for (reference, first, last) in [(View::Left, 101, 103), (View::Right, 97, 99)] {
            let mask = seen(None, Some(&other)).near_partners(reference, range(1, 3)).unwrap();
            let is_near = |x: u32, y: u32| (first - 32..=last + 32).contains(&x) && (40 - 32..=40 + 32).contains(&y);
            let expected = Luma::from_fn((200, 100), |x, y| if is_near(x, y) { 255 } else { 0 });
            assert_eq!(mask, expected, "{reference:?}");
        }
        let own = Luma::from_fn((200, 100), |x, _| if x == 102 { 0 } else { 255 });
        let mask = seen(Some(&own), Some(&other)).near_partners(View::Left, range(1, 3)).unwrap();
        assert_eq!([101, 102, 103, 136].map(|x| mask.get(x, 40)), [255, 0, 255, 0]);
        // Beyond the edges the mask goes on.
        let edge = Luma::from_fn((200, 1), |x, _| if x == 0 { 255 } else { 0 });
        let mask = seen(None, Some(&edge)).near_partners(View::Left, range(3, 2)).unwrap();
        assert_eq!(mask, Luma::from_fn((200, 1), |x, _| if x <= 4 + 32 { 255 } else { 0 }));
        assert!(seen(Some(&own), None).near_partners(View::Left, range(0, 1)).is_none());
    }
}
