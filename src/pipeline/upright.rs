//! A pair whose columns lean, matched with its columns upright.

use glam::DVec2;

use super::{Outcome, RectifiedPair};
use crate::{
    dense::Dense,
    disparity::{DisparityRange, NONE, SCALE},
    features::Feature,
    image::{Plane, Size},
    matching::Seed,
    rectify::{RowModel, StereoRectification},
    seeding::{FoundRange, Rectification, Seeding},
};

impl RectifiedPair {
    /// The outcome of the pair as it was taken, by that of this pair: places and disparities are those of the views as they were taken; the
    /// coarse map, of which trust alone depends, stays that of this pair. `None` if the left view was resampled, which has the map.
    pub fn restored(&self, upright: Outcome) -> Option<Outcome> {
        let StereoRectification::Uncalibrated(found) = &self.rectification else { return None };
        if !self.rectification.keeps_left() {
            return None;
        }
        let moved = Moved { pair: self, rows: upright.seeding.rectification.rows };
        let disparity = Plane::from_fn(upright.dense.disparity.size(), |x, y| {
            let disparity = match upright.dense.disparity.get(x, y) {
                NONE => return NONE,
                found => f64::from(found) / f64::from(SCALE),
            };
            moved
                .disparity(DVec2::new(x.into(), y.into()), disparity)
                .map_or(NONE, |disparity| (disparity * f64::from(SCALE)).round() as i32)
        });
        let [left, right] = upright.features;
        let [left_mask, _] = upright.masks;
        let right: Option<Vec<Feature>> = right.into_iter().map(|point| moved.feature(point)).collect();
        let seeds: Option<Vec<Seed>> = upright.seeding.seeds.iter().map(|seed| moved.seed(seed)).collect();
        let rows = moved.rows.behind(&found.homographies[1], found.size);
        let rectification =
            Rectification { lean: moved.lean()?, ..upright.seeding.rectification.along(rows, found.size) };
        let range = match upright.seeding.range {
            Ok(found) => {
                let [least, most] = found.seen.map(f64::from);
                let seen = moved.span([least, most])?.map(|end| end as f32);
                Ok(FoundRange { range: moved.range(found.range)?, seen, ..found })
            }
            thin => thin,
        };
        Some(Outcome {
            features: [left, right?],
            seeding: Seeding { range, rectification, seeds: seeds?, ..upright.seeding },
            range: moved.range(upright.range)?,
            masks: [left_mask, self.right.seen.mask.clone()],
            dense: Dense { disparity, confidence: upright.dense.confidence },
            ..upright
        })
    }
}

/// Places of a rectified pair, whose right rows were moved by `rows`, in the views as they were taken.
struct Moved<'a> {
    pair: &'a RectifiedPair,
    rows: RowModel,
}

impl Moved<'_> {
    /// The place in the right view that a place of the rectified right picture shows.
    fn taken(&self, right: DVec2) -> Option<DVec2> {
        self.pair.rectification.source_of(1, right)
    }

    /// The disparity in the views as they were taken of a left pixel that has `disparity` in the rectified pair.
    fn disparity(&self, left: DVec2, disparity: f64) -> Option<f64> {
        let column = left.x - disparity;
        Some(left.x - self.taken(DVec2::new(column, self.rows.right_row(column, left.y)))?.x)
    }

    fn feature(&self, point: Feature) -> Option<Feature> {
        let place = self.taken(DVec2::new(point.x.into(), point.y.into()))?.as_vec2();
        Some(Feature { x: place.x, y: place.y, ..point })
    }

    fn seed(&self, seed: &Seed) -> Option<Seed> {
        let right = self.taken(DVec2::new(seed.right_x().into(), seed.right_y().into()))?.as_vec2();
        Some(Seed { disparity: seed.x - right.x, dy: right.y - seed.y, ..*seed })
    }

    /// The change per row of disparities that are equal in the rectified pair, at the centre of the picture.
    fn lean(&self) -> Option<f32> {
        let Size { width, height } = self.pair.rectification.size();
        let centre = (DVec2::new(width.into(), height.into()) - 1.0) / 2.0;
        let [above, below] = [-0.5, 0.5].map(|step| self.disparity(centre + DVec2::new(0.0, step), 0.0));
        Some((below? - above?) as f32)
    }

    /// The least and the most disparity that `ends` become, in the corners of the picture, between which a shear and a stretch of the
    /// columns change them steadily.
    fn span(&self, ends: [f64; 2]) -> Option<[f64; 2]> {
        let Size { width, height } = self.pair.rectification.size();
        let corners = [(0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)];
        let corners = corners.map(|(x, y)| DVec2::new(x.into(), y.into()));
        let all = corners.iter().flat_map(|&corner| ends.map(|end| self.disparity(corner, end)));
        all.map(|found| found.map(|d| [d, d])).reduce(|a, b| {
            let ([least, most], [d, _]) = (a?, b?);
            Some([least.min(d), most.max(d)])
        })?
    }

    /// All disparities that a search of `range` can have found.
    fn range(&self, range: DisparityRange) -> Option<DisparityRange> {
        let [least, most] = self.span([range.min, range.last()].map(f64::from))?;
        DisparityRange::inclusive(least.floor() as i32, most.ceil() as i32).ok()
    }
}
