//! What was found in reduced views, in the pixels of the whole ones.

use super::{Rectification, Seeding};
use crate::{disparity::DisparityRange, features::Feature, matching::Seed};

/// The place, in the whole picture, of a place in one that is smaller by `factor`: the centre of a block.
fn place(reduced: f32, factor: f32) -> f32 {
    factor * reduced + (factor - 1.0) / 2.0
}

/// A feature of a picture that is smaller by `factor`, in the whole one.
pub fn enlarged_feature(feature: Feature, factor: u32) -> Feature {
    let factor = factor as f32;
    Feature { x: place(feature.x, factor), y: place(feature.y, factor), scale: factor * feature.scale, ..feature }
}

/// All whole disparities that become one of `range` in views that are smaller by `factor`.
pub(super) fn enlarged_range(range: DisparityRange, factor: u32) -> DisparityRange {
    let limit = DisparityRange::LIMIT;
    let factor = factor as i32;
    let end = |disparity: i32, more: i32| disparity.saturating_mul(factor).saturating_add(more).clamp(-limit, limit);
    let (min, last) = (end(range.min, 1 - factor), end(range.last(), factor - 1));
    DisparityRange { min, count: (last - min) as u32 + 1 }
}

impl Seeding {
    /// The same for views that are larger by `factor` than those it was found in.
    ///
    /// Lengths grow with the views, and so does what counts as rectified: 1.5 px of the reduced views.
    #[must_use]
    pub fn enlarged(self, factor: u32) -> Self {
        let scale = factor as f32;
        let rectification = self.rectification;
        let seed = |seed: &Seed| Seed {
            x: place(seed.x, scale),
            y: place(seed.y, scale),
            disparity: scale * seed.disparity,
            dy: scale * seed.dy,
            ..*seed
        };
        Self {
            range: self.range.map(|range| enlarged_range(range, factor)),
            rectification: Rectification {
                offset: scale * rectification.offset,
                residual: scale * rectification.residual,
                largest: scale * rectification.largest,
                ..rectification
            },
            seeds: self.seeds.iter().map(seed).collect(),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_whatever_is_rounded_into_it() {
        let range = DisparityRange::inclusive(-2, 5).unwrap();
        // In blocks of three: -2 stands for -8 to -4, 5 for 13 to 17.
        assert_eq!(enlarged_range(range, 3), DisparityRange::inclusive(-8, 17).unwrap());
        assert_eq!(enlarged_range(range, 1), range);
    }

    #[test]
    fn the_first_block_of_two_lies_around_a_half() {
        assert_eq!(place(0.0, 2.0), 0.5);
        assert_eq!(place(3.0, 1.0), 3.0);
    }
}
