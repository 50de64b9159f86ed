//! Frames of a sequence: what one was found to be holds for the next ones, until they show that it does not.
//!
//! A frame that follows a precedent has no interest points of its own: its rows, the change of brightness and the range are the
//! precedent's. Four bounds show that they hold: the coarse map of the frame, whose surfaces must lie within the range; the map, which must
//! not end at an end of the range; its trust; and the relation of the mean levels of the views. Rows that differ from the precedent's lower
//! the trust, and by less than a pixel hardly: someone must see to it that a sequence has a new precedent now and then.

use super::{
    Given, Matched, Outcome, Step,
    clock::Clock,
    known::{Known, brightness, repetition_of},
    range::{RangeSource, is_cut},
    reduction::reduction,
    trust::TRUSTED,
    views::Views,
};
use crate::{
    backend::Backend, config::Config, disparity::DisparityRange, error::Result, image::Size, io::Picture,
    seeding::Seeding,
};

/// Largest change of the relation of the mean levels of both views: 2 %. The gain of the right view is a whole number of 1/256.
const MOST_CHANGE: f64 = 0.02;
/// Largest loss of trust against the precedent.
const MOST_LOSS: f32 = 0.1;

/// What a frame of a sequence tells the frames after it, of cameras that stand still against each other, in a search by the same
/// parameters.
#[derive(Clone, Debug)]
pub struct Precedent {
    size: Size,
    seeding: Seeding,
    range: DisparityRange,
    range_source: RangeSource,
    trust: f32,
    relation: f64,
}

impl Matched {
    /// What this frame, of these `views`, tells the frames after it: nothing if it follows another one, was rectified first, has
    /// columns that lean, or is doubtful.
    pub fn precedent(&self, views: (&Picture, &Picture)) -> Option<Precedent> {
        let Outcome { seeding, range, range_source, trust, no_depth, mosaics, .. } = &self.outcome;
        let tells = !self.follows && self.rectified.is_none() && *trust >= TRUSTED && no_depth.is_none();
        let is_found = !matches!(range_source, RangeSource::Fallback(_)) && *mosaics == [false; 2];
        // Its map may be that of upright columns, which rows alone do not give.
        let is_upright = seeding.rectification.lean == 0.0;
        (tells && is_found && is_upright).then(|| Precedent {
            size: views.0.size(),
            seeding: Seeding { matches: Vec::new(), ..seeding.clone() },
            range: *range,
            range_source: *range_source,
            trust: *trust,
            relation: relation(views),
        })
    }
}

impl Precedent {
    /// The outcome of the next frame, if the precedent holds for it.
    pub(super) async fn followed(
        &self,
        backend: &Backend,
        (left, right): (&Picture, &Picture),
        config: &Config,
        begin: impl FnMut(Step),
        progress: impl FnMut(f32),
    ) -> Result<Option<Outcome>> {
        let has_size = left.size() == self.size && right.size() == self.size;
        if !has_size || (relation((left, right)) / self.relation - 1.0).abs() > MOST_CHANGE {
            return Ok(None);
        }
        let mut clock = Clock::new(begin);
        clock.enter(Step::Luma);
        let given = Given { pictures: [left, right], rectified: None };
        let views = Views::new(backend, given.pictures, config).await?;
        let repetition = repetition_of(&views);
        let factor = reduction(self.size);
        let views = views.aligned(&self.seeding.rectification.rows).await?;

        clock.enter(Step::Seeding);
        let brightness = brightness(config, &self.seeding);
        let seeding = {
            let [left, right] = views.reduced(factor);
            let [seen, _] = views.masks(factor);
            self.seeding.followed((&left, &right), seen.as_ref(), factor, brightness)?
        };
        let is_asked = self.range_source == RangeSource::Asked;
        if !is_asked && !seeding.holds(self.range, self.range_source.ends_at_zero()) {
            return Ok(None);
        }

        clock.enter(Step::Dense);
        let known = Known {
            features: [Vec::new(), Vec::new()],
            points_found: [0; 2],
            seeding,
            range: self.range,
            range_source: self.range_source,
            widens: false,
            brightness,
            repetition,
            factor,
        };
        let outcome = known.matched(views, &given, config, progress).await?;
        let holds = !is_cut(self.range_source, outcome.at_ends)
            && outcome.no_depth.is_none()
            && outcome.trust >= TRUSTED.max(self.trust - MOST_LOSS);
        Ok(holds.then(|| Outcome { times: clock.finish(), ..outcome }))
    }
}

/// Mean level of the right view by that of the left one.
fn relation((left, right): (&Picture, &Picture)) -> f64 {
    let [left, right] = [left, right].map(|view| {
        let levels = |[red, green, blue, _]: &[u8; 4]| u64::from(*red) + 2 * u64::from(*green) + u64::from(*blue);
        view.data().iter().map(levels).sum::<u64>().max(1)
    });
    right as f64 / left as f64
}
