//! Conversion of results from reduced views to pixels of the full-size views.

use super::{FoundRange, RangeEnd, Rectification, Seeding};
use crate::{disparity::DisparityRange, features::Feature, matching::Seed};

/// Coordinate in the full-size picture of a coordinate in the picture reduced by `factor`: the centre of a block.
fn place(reduced: f32, factor: f32) -> f32 {
    factor * reduced + (factor - 1.0) / 2.0
}

/// Converts a feature of a picture reduced by `factor` to pixels of the full-size picture.
pub fn enlarged_feature(feature: Feature, factor: u32) -> Feature {
    let factor = factor as f32;
    Feature { x: place(feature.x, factor), y: place(feature.y, factor), scale: factor * feature.scale, ..feature }
}

/// The range of all whole disparities that a reduction of the views by `factor` rounds into `range`.
pub(super) fn enlarged_range(range: DisparityRange, factor: u32) -> DisparityRange {
    let limit = DisparityRange::LIMIT;
    let factor = factor as i32;
    let end = |disparity: i32, more: i32| disparity.saturating_mul(factor).saturating_add(more).clamp(-limit, limit);
    let (min, last) = (end(range.min, 1 - factor), end(range.last(), factor - 1));
    DisparityRange { min, count: (last - min) as u32 + 1 }
}

/// The part of a range from 0 upwards.
fn from_zero(range: DisparityRange) -> DisparityRange {
    DisparityRange { min: 0, count: (range.last() + 1).max(1).cast_unsigned() }
}

impl Rectification {
    /// Converts the figures and the model of the rows to views enlarged by `factor`.
    #[must_use]
    pub fn enlarged(self, factor: u32) -> Self {
        let scale = factor as f32;
        Self {
            rows: self.rows.enlarged(factor),
            offset: scale * self.offset,
            residual: scale * self.residual,
            remaining: scale * self.remaining,
            unexplained: scale * self.unexplained,
            largest: scale * self.largest,
            ..self
        }
    }
}

impl Seeding {
    /// Converts the result to views enlarged by `factor`.
    ///
    /// All lengths grow by `factor`, and so does the row difference that counts as none: 1/16 px of the reduced views.
    #[must_use]
    pub fn enlarged(self, factor: u32) -> Self {
        let scale = factor as f32;
        let seed = |seed: &Seed| Seed {
            x: place(seed.x, scale),
            y: place(seed.y, scale),
            disparity: scale * seed.disparity,
            dy: scale * seed.dy,
            ..*seed
        };
        Self {
            range: self.range.map(|found| FoundRange {
                range: match found.ends[0] {
                    RangeEnd::Zero => from_zero(enlarged_range(found.range, factor)),
                    RangeEnd::Seeds | RangeEnd::CoarseMap => enlarged_range(found.range, factor),
                },
                seen: found.seen.map(|disparity| scale * disparity),
                ..found
            }),
            rectification: self.rectification.enlarged(factor),
            coarse: self.coarse.enlarged(factor),
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
        // With blocks of three pixels, -2 stands for -8 to -4, and 5 for 13 to 17.
        assert_eq!(enlarged_range(range, 3), DisparityRange::inclusive(-8, 17).unwrap());
        assert_eq!(enlarged_range(range, 1), range);
        assert_eq!(from_zero(enlarged_range(DisparityRange::inclusive(0, 5).unwrap(), 3)).min, 0);
    }

    #[test]
    fn the_first_block_of_two_lies_around_a_half() {
        assert_eq!(place(0.0, 2.0), 0.5);
        assert_eq!(place(3.0, 1.0), 3.0);
    }
}
