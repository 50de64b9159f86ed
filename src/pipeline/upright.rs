//! A pair whose columns lean, matched with its columns upright.

use glam::DVec2;

use super::{Outcome, RectifiedPair};
use crate::{
    dense::Dense,
    disparity::{DisparityRange, NONE, SCALE},
    image::{Plane, Size},
    rectify::RowModel,
};

impl RectifiedPair {
    /// The outcome of the pair as it was taken, whose rows correspond, with the map of this pair, of which `upright` is the outcome;
    /// disparities are those of the views as they were taken. `None` if the left view was resampled, which has the map.
    pub fn restored(&self, as_taken: &Outcome, upright: &Outcome) -> Option<Outcome> {
        if !self.rectification.keeps_left() {
            return None;
        }
        let rows = &upright.seeding.rectification.rows;
        let there =
            |x: u32, y: u32, disparity: f64| self.taken_disparity(rows, DVec2::new(x.into(), y.into()), disparity);
        let Dense { disparity, confidence } = &upright.dense;
        let restored = |x: u32, y: u32| match disparity.get(x, y) {
            NONE => NONE,
            found => there(x, y, f64::from(found) / f64::from(SCALE))
                .map_or(NONE, |disparity| (disparity * f64::from(SCALE)).round() as i32),
        };
        let disparity = Plane::from_fn(disparity.size(), restored);
        let range = self.taken_range(&there, upright.range)?;
        let times = [&as_taken.times[..], &upright.times[..]].concat();
        let (trust, at_ends) = (upright.trust, upright.at_ends);
        let dense = Dense { disparity, confidence: confidence.clone() };
        Some(Outcome { dense, range, trust, at_ends, times, ..as_taken.clone() })
    }

    /// The disparity in the views as they were taken of a left pixel that has `disparity` in the rectified pair, whose right rows were
    /// moved by `rows`.
    fn taken_disparity(&self, rows: &RowModel, left: DVec2, disparity: f64) -> Option<f64> {
        let column = left.x - disparity;
        let right = DVec2::new(column, rows.right_row(column, left.y));
        Some(left.x - self.rectification.source_of(1, right)?.x)
    }

    /// All disparities that a search of `range` can have found: its ends in the corners of the picture, between which a shear and a
    /// stretch of the columns change them steadily.
    fn taken_range(
        &self,
        there: &impl Fn(u32, u32, f64) -> Option<f64>,
        range: DisparityRange,
    ) -> Option<DisparityRange> {
        let Size { width, height } = self.rectification.size();
        let corners = [(0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)];
        let ends = [range.min, range.last()].map(f64::from);
        let found: Vec<f64> =
            corners.iter().flat_map(|&(x, y)| ends.map(|end| there(x, y, end))).collect::<Option<_>>()?;
        let (least, most) = found.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &d| (a.min(d), b.max(d)));
        DisparityRange::inclusive(least.floor() as i32, most.ceil() as i32).ok()
    }
}
