//! From two pictures, as someone has them, to a map and the doubts about it.

use super::{
    Judgement, Mirrored, Outcome, Precedent, RectifiedPair, Step, TRUSTED, doubts,
    mirror::mirrored_async,
    way::{Found, Way},
};
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::block_on;
use crate::{
    backend::Backend,
    config::Config,
    error::{Error, Result},
    io::{Calibration, Picture},
};

/// A pair that shall be matched.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// What computes the map.
    pub backend: &'a Backend,
    /// The left and the right view.
    pub views: (&'a Picture, &'a Picture),
    /// The parameters.
    pub config: &'a Config,
    /// How the rows of the pair come to correspond.
    pub way: &'a Way,
    /// The geometry of the pair if its pictures are rectified already.
    pub calibration: Option<Calibration>,
    /// An earlier frame of the sequence that the pair belongs to: what it was found to be holds for the pair too, unless that shows
    /// otherwise.
    pub precedent: Option<&'a Precedent>,
    /// Called with what begins.
    pub begin: &'a dyn Fn(Activity),
    /// Called with the share of [`Step::Dense`] that a device has done, see [`super::run_with_progress`].
    pub progress: &'a dyn Fn(f32),
}

/// What is done to a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Its rows are brought to correspond.
    Rectifying,
    /// One view is looked at as a mirror image, since the pair was refused or its map is not to be trusted.
    LookingForMirrorImage,
    /// A step of the pipeline.
    Step(Step),
}

/// A matched pair.
#[derive(Clone, Debug)]
pub struct Matched {
    /// The map and what was found on the way.
    pub outcome: Outcome,
    /// The pair that was matched, if it was rectified first.
    pub rectified: Option<RectifiedPair>,
    /// What is to be said of the map.
    pub judgement: Judgement,
    /// Whether the precedent held.
    pub follows: bool,
}

impl Task<'_> {
    /// Matches the pair.
    ///
    /// # Errors
    /// See [`super::run`]; [`Error::NotRectifiable`] also for a view that is the mirror image of the other.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn run(&self) -> Result<Matched> {
        block_on(self.run_async())
    }

    /// The asynchronous [`Self::run`]. Work on the host blocks.
    ///
    /// # Errors
    /// See [`Self::run`].
    pub async fn run_async(&self) -> Result<Matched> {
        let followed = self.followed().await?;
        let follows = followed.is_some();
        let found = match followed {
            Some(outcome) => Ok(Found { outcome, rectified: None, warnings: Vec::new() }),
            None => self.on_its_way().await,
        };
        let mirrored = self.mirrored(&found).await?;
        let Found { outcome, rectified, warnings } = match (found, mirrored) {
            (Err(_), Some(sides)) => return Err(Error::NotRectifiable { reason: doubts::mirrored(sides) }),
            (found, _) => found?,
        };
        let mut judgement = match &rectified {
            Some(pair) => Judgement::of_rectified(&outcome, pair, self.config, mirrored),
            None => Judgement::of_taken(&outcome, self.views, self.calibration, self.config, mirrored),
        };
        judgement.warnings.splice(0..0, warnings);
        Ok(Matched { outcome, rectified, judgement, follows })
    }

    /// The outcome by the precedent, if there is one and it holds.
    async fn followed(&self) -> Result<Option<Outcome>> {
        let Some(precedent) = self.precedent else { return Ok(None) };
        self.config.validate()?;
        let begin = |step| (self.begin)(Activity::Step(step));
        precedent.followed(self.backend, self.views, self.config, begin, self.progress).await
    }

    /// How one view mirrors the other, which is found out where the pair was refused or its map is not to be trusted.
    async fn mirrored(&self, found: &Result<Found>) -> Result<Option<Mirrored>> {
        let is_doubtful = match found {
            Ok(Found { outcome, .. }) => outcome.trust < TRUSTED && outcome.no_depth.is_none(),
            Err(error) => matches!(error, Error::NotRectified { .. } | Error::NotRectifiable { .. }),
        };
        if !is_doubtful {
            return Ok(None);
        }
        (self.begin)(Activity::LookingForMirrorImage);
        mirrored_async(self.backend, self.views).await
    }
}
