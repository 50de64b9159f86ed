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

impl Seen<'_> {
    /// The mask of the reference view without the pixels that have no partner which the other view shows, at any disparity of `range`:
    /// nothing tells their disparity. `None` if the other view shows all.
    ///
    /// Beyond the edges of the other view its mask goes on.
    pub fn with_partners(&self, reference: View, range: DisparityRange) -> Option<Luma> {
        let [own, other] = self.masks;
        let other = other?;
        let ends = [range.min, range.last()].map(|disparity| reference.direction() * disparity);
        let reach = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let Size { width, height } = other.size();
        let column = |x: u32, step: i32| (i64::from(x) + i64::from(step)).clamp(0, i64::from(width) - 1) as usize;
        // Shown pixels before each column.
        let shown: Vec<Vec<u32>> = (0..height)
            .map(|y| {
                let mut count = 0;
                let after = other.row(y).iter().map(|&value| {
                    count += u32::from(value != 0);
                    count
                });
                std::iter::once(0).chain(after).collect()
            })
            .collect();
        Some(in_parallel(other.size(), |x, y| {
            let row = &shown[y as usize];
            let has_partner = row[column(x, reach[1]) + 1] > row[column(x, reach[0])];
            let own = own.map_or(u8::MAX, |mask| mask.get(x, y));
            if has_partner { own } else { 0 }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_without_any_partner_are_hidden() {
        let other = Luma::from_fn((12, 2), |x, y| if y == 0 && (4..6).contains(&x) { 255 } else { 0 });
        let own = Luma::from_fn((12, 2), |x, _| if x == 6 { 0 } else { 255 });
        let shown = |reference, min, count, own| {
            let seen = Seen { masks: [own, Some(&other)], loss: Loss::Nothing };
            let mask = seen.with_partners(reference, DisparityRange::new(min, count).unwrap()).unwrap();
            assert!(mask.row(1).iter().all(|&value| value == 0));
            (0..12).filter(|&x| mask.get(x, 0) == 255).collect::<Vec<u32>>()
        };
        // Partners at x - 1 to x - 3, and at x + 1 to x + 3.
        assert_eq!(shown(View::Left, 1, 3, None), [5, 6, 7, 8]);
        assert_eq!(shown(View::Left, 1, 3, Some(&own)), [5, 7, 8]);
        assert_eq!(shown(View::Right, 1, 3, None), [1, 2, 3, 4]);
        // Beyond the edges the mask goes on.
        let edge = Luma::from_fn((12, 1), |x, _| if x == 0 { 255 } else { 0 });
        let seen = Seen { masks: [None, Some(&edge)], loss: Loss::Nothing };
        let mask = seen.with_partners(View::Left, DisparityRange::new(3, 2).unwrap()).unwrap();
        assert_eq!(mask.data(), Luma::from_fn((12, 1), |x, _| if x < 5 { 255 } else { 0 }).data());
        assert!(
            Seen { masks: [Some(&own), None], loss: Loss::Nothing }
                .with_partners(View::Left, DisparityRange::new(0, 1).unwrap())
                .is_none()
        );
    }
}
