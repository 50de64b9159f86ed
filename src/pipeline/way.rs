//! How the rows of a pair come to correspond: as it is, from its matches, or by its calibration.

use super::{
    Outcome, RectifiedPair, TRUSTED, TakenPair,
    rectified::rectify_by_async,
    run_rectified, run_unless, run_with_progress,
    taken_pair::rectify_async,
    task::{Activity, Task},
};
use crate::{
    calibration::StereoCalibration,
    config::Config,
    dense::View,
    disparity,
    error::{Error, Result},
    seeding::{Rectification, Verdict},
};

/// Share of the pixels with a disparity from which a map with the columns upright needs no comparison, 0 to 1. The scene `planes` turned by
/// 4 and 5 degrees has 0.77 to 0.82 with `fast`; scenes of two planes that lean in two ways, where one loses what the other gains, 0.2 to 0.7.
const WHOLE: f64 = 0.75;

/// How the rows of a pair come to correspond.
#[derive(Clone, Debug)]
pub enum Way {
    /// They do, or the pair is refused.
    AsIs,
    /// By matching interest points, if need be.
    AsNeeded,
    /// By matching interest points.
    Uncalibrated,
    /// By the calibration of the pair as it was taken.
    Calibrated(StereoCalibration),
    /// By the calibration if that brings rows closer together, since the files are of the pair as it was taken and of the rectified
    /// one; otherwise as needed.
    Either(StereoCalibration),
}

/// What matching gave, and the rectified pair that was matched, if one was.
pub(super) struct Found {
    pub outcome: Outcome,
    pub rectified: Option<RectifiedPair>,
    pub warnings: Vec<String>,
}

/// What came of a pair as it was taken.
enum AsItIs {
    Matched(Box<Outcome>),
    /// Not matched: the lens distorts its rows.
    Distorted,
    /// Not matched: its columns lean.
    Leaning,
}

impl AsItIs {
    fn outcome(self) -> Option<Outcome> {
        match self {
            Self::Matched(outcome) => Some(*outcome),
            Self::Distorted | Self::Leaning => None,
        }
    }
}

impl Task<'_> {
    /// Matches the pair on its way.
    pub(super) async fn on_its_way(&self) -> Result<Found> {
        match self.way {
            Way::AsIs => {
                self.as_it_is(self.config.force).await.map(as_taken).map_err(|error| kept(error, "`rectify` never"))
            }
            Way::AsNeeded => self.as_needed().await,
            Way::Uncalibrated => {
                (self.begin)(Activity::Rectifying);
                self.along_rows_of(rectify_async(self.backend, self.views).await?).await
            }
            Way::Calibrated(stereo) => self.along_rows_of(self.rectified_by(stereo).await?).await,
            Way::Either(_) if !self.config.align => self.as_needed().await,
            Way::Either(stereo) => {
                let pair = self.rectified_by(stereo).await?;
                if !pair.is_better_than_taken() {
                    return self.as_needed().await;
                }
                let mut found = self.along_rows_of(pair).await?;
                found.warnings.push(
                    "the calibration is of pictures as they were taken and of rectified ones: these were rectified by it, since their \
                     rows correspond better then; `rectify` never takes them as rectified"
                        .into(),
                );
                Ok(found)
            }
        }
    }

    async fn rectified_by(&self, stereo: &StereoCalibration) -> Result<RectifiedPair> {
        (self.begin)(Activity::Rectifying);
        rectify_by_async(self.backend, self.views, stereo).await
    }

    async fn as_it_is(&self, force: bool) -> Result<Outcome> {
        let config = Config { force, ..self.config.clone() };
        run_with_progress(self.backend, self.views, &config, |step| (self.begin)(Activity::Step(step)), self.progress)
            .await
    }

    /// Matches the pair as it was taken, unless its rows tell of something that a rectification mends: the lens distorts them, which no
    /// warp of the rows of one view mends and a calibration tells better; or its columns lean, if `may_lean`.
    async fn as_it_is_if_fit(&self, may_lean: bool) -> Result<AsItIs> {
        let config = Config { force: false, ..self.config.clone() };
        let mut unfit = None;
        let is_unfit = |rows: &Rectification| {
            if rows.is_distorted() && self.calibration.is_none() {
                unfit = Some(AsItIs::Distorted);
            } else if rows.lean != 0.0 && may_lean {
                unfit = Some(AsItIs::Leaning);
            }
            unfit.is_some()
        };
        let begin = |step| (self.begin)(Activity::Step(step));
        let matched = run_unless(self.backend, self.views, &config, is_unfit, begin, self.progress).await?;
        Ok(unfit.or(matched.map(|outcome| AsItIs::Matched(Box::new(outcome)))).expect("an outcome of a fit pair"))
    }

    /// Matches a rectified pair.
    async fn along_rows_of(&self, pair: RectifiedPair) -> Result<Found> {
        let begin = |step| (self.begin)(Activity::Step(step));
        let outcome = run_rectified(self.backend, &pair, self.config, begin, self.progress).await;
        let outcome = outcome.map_err(|error| match error {
            Error::NotRectified { diagnosis } if pair.rectification.calibration().is_some() => {
                let diagnosis =
                    format!(
                        "the calibration does not fit the pictures, or left and right are mixed up: after the rectification {diagnosis}"
                    );
                Error::NotRectified { diagnosis }
            }
            error => error,
        })?;
        Ok(Found { outcome, rectified: Some(pair), warnings: Vec::new() })
    }

    /// Matches the pair as it is, or rectified from its matches if its rows do not correspond.
    ///
    /// With [`Config::force`], or without [`Config::align`], a pair that cannot be rectified, or must not be, is matched or refused
    /// as with [`Way::AsIs`].
    async fn as_needed(&self) -> Result<Found> {
        let force = self.config.force;
        if !self.config.align {
            return self.as_it_is(force).await.map(as_taken).map_err(|error| kept(error, "`no_align`"));
        }
        let mut looked = self.first_look().await?;
        let mut leaning = looked.take_if(|pair| leans(pair));
        // The doubtful outcome, if any, with the columns upright, once that was tried.
        let mut upright = None;
        let as_is = loop {
            if let Some(pair) = leaning.take() {
                match self.with_upright_columns(pair).await? {
                    Some(outcome) if outcome.trust >= TRUSTED && coverage(&outcome) >= WHOLE => {
                        return Ok(as_taken(outcome));
                    }
                    doubtful => upright = Some(doubtful),
                }
            }
            match looked.as_ref().and_then(TakenPair::rows) {
                Some(rows) if rows.is_distorted() => break Ok(None),
                Some(rows) => break Err(Error::NotRectified { diagnosis: rows.to_string() }),
                None => {}
            }
            match self.as_it_is_if_fit(self.can_lean() && upright.is_none()).await {
                Ok(AsItIs::Leaning) => leaning = Some(TakenPair::new_async(self.backend, self.views).await?),
                as_is => break as_is.map(AsItIs::outcome),
            }
        };
        let why = match &as_is {
            Err(error @ Error::SizesDiffer { .. }) => error.to_string(),
            Err(Error::NotRectified { diagnosis }) => format!("the pair is not rectified: {diagnosis}"),
            Ok(None) => "the lens distorts the pictures".into(),
            Ok(Some(outcome)) if has_unknown_rows(outcome) => {
                "nothing tells whether the rows of the views correspond".into()
            }
            _ => {
                return match (as_is?, upright.flatten()) {
                    (Some(outcome), Some(upright))
                        if has_leaning_columns(&outcome) && is_as_good(worth(&upright), worth(&outcome)) =>
                    {
                        Ok(as_taken(upright))
                    }
                    (outcome, _) => self.taken_or(outcome).await,
                };
            }
        };
        (self.begin)(Activity::Rectifying);
        let was_looked_at = looked.is_some();
        let pair = match looked {
            Some(pair) => pair.rectify_async(self.backend).await,
            None => rectify_async(self.backend, self.views).await,
        };
        let refused = match pair {
            Ok(pair) => {
                let mut why = why;
                if matches!(as_is, Ok(None)) && pair.rectification.distortion() == [0.0; 2] {
                    // To a first look, parallax across the rows is like a distortion.
                    match self.as_it_is(force).await {
                        Err(Error::NotRectified { diagnosis }) => {
                            why = format!("the pair is not rectified: {diagnosis}")
                        }
                        outcome => return Ok(as_taken(outcome?)),
                    }
                }
                let mut found = self.along_rows_of(pair).await?;
                found
                    .warnings
                    .insert(0, format!("{why}; disparities are those of the pair rectified from its matches"));
                return Ok(found);
            }
            Err(Error::NotRectifiable { reason }) => reason,
            Err(error) => return Err(error),
        };
        let as_is = if was_looked_at { self.as_it_is_if_fit(false).await.map(AsItIs::outcome) } else { as_is };
        let outcome = match as_is {
            Err(Error::NotRectified { .. }) if force => self.as_it_is(true).await?,
            Err(Error::NotRectified { diagnosis }) => {
                let diagnosis = format!("no warp that matches tell helps, since {refused}; {diagnosis}");
                return Err(Error::NotRectified { diagnosis });
            }
            Err(Error::SizesDiffer { left, right }) => {
                let reason = format!("{refused} (the left view is {left} and the right view {right} pixels)");
                return Err(Error::NotRectifiable { reason });
            }
            as_is => return self.taken_or(as_is?).await,
        };
        Ok(as_taken(outcome))
    }

    /// The pair, if a first look tells that it is not to be matched as it was taken: rows differ by more than a small warp mends, the
    /// lens distorts them, or columns lean. With a calibration, which is of a rectified pair then, nobody looks.
    async fn first_look(&self) -> Result<Option<TakenPair>> {
        if self.calibration.is_some() {
            return Ok(None);
        }
        (self.begin)(Activity::Rectifying);
        let pair = TakenPair::new_async(self.backend, self.views).await?;
        let is_unfit = pair.rows().is_some_and(|rows| rows.is_distorted() || rows.rows_differ());
        Ok(Some(pair).filter(|pair| is_unfit || self.can_lean() && leans(pair)))
    }

    /// The outcome of the pair as it was taken, if it was matched; else it is matched now.
    async fn taken_or(&self, outcome: Option<Outcome>) -> Result<Found> {
        Ok(as_taken(match outcome {
            Some(outcome) => outcome,
            None => self.as_it_is(self.config.force).await?,
        }))
    }

    /// Whether the pair may be matched with the columns of the right view upright: a range that was asked for is one of the columns as
    /// they are, and the map of the right view is too.
    fn can_lean(&self) -> bool {
        self.config.range.is_none() && self.config.least.is_none() && self.config.reference == View::Left
    }

    /// The outcome with the columns of the right view upright, with the disparities of the pair as it was taken; `None` if the pair cannot
    /// be rectified, or the left view does not stay.
    async fn with_upright_columns(&self, pair: TakenPair) -> Result<Option<Outcome>> {
        (self.begin)(Activity::Rectifying);
        let pair = match pair.rectify_async(self.backend).await {
            Ok(pair) if pair.rectification.keeps_left() => pair,
            Ok(_) | Err(Error::NotRectifiable { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let upright = self.along_rows_of(pair).await?;
        Ok(upright.rectified.and_then(|pair| pair.restored(upright.outcome)))
    }
}

/// Whether a first look at a pair whose rows correspond, or nearly, tells that its columns lean.
fn leans(pair: &TakenPair) -> bool {
    let leans = |rows: Rectification| rows.lean != 0.0 && !rows.is_distorted();
    pair.is_of_one_size() && pair.rows().is_some_and(leans)
}

/// Whether most surfaces of a map share a slant, as where the columns of the right view lean.
fn has_leaning_columns(outcome: &Outcome) -> bool {
    outcome.seeding.rectification.lean != 0.0 && outcome.no_depth.is_none()
}

/// Share of the pixels that have a disparity, 0 to 1.
fn coverage(outcome: &Outcome) -> f64 {
    disparity::coverage(&outcome.dense.disparity)
}

/// Trust and coverage of a map.
fn worth(outcome: &Outcome) -> (f32, f64) {
    (outcome.trust, coverage(outcome))
}

/// Whether a map is at least as good as another one of the same pair, by what they are worth: it shows as much where both are to be trusted,
/// or is to be trusted more.
fn is_as_good((trust, coverage): (f32, f64), (other_trust, other_coverage): (f32, f64)) -> bool {
    match trust.min(other_trust) >= TRUSTED {
        true => coverage >= other_coverage,
        false => trust >= other_trust,
    }
}

/// The outcome of a pair that was matched as it was taken.
fn as_taken(outcome: Outcome) -> Found {
    Found { outcome, rectified: None, warnings: Vec::new() }
}

/// The error of a pair that `option` keeps from being rectified.
fn kept(error: Error, option: &str) -> Error {
    match error {
        Error::NotRectified { diagnosis } => {
            Error::NotRectified { diagnosis: format!("{diagnosis}; {option} keeps the pair from being rectified") }
        }
        error => error,
    }
}

/// Whether a map is not to be trusted since nothing tells whether rows correspond.
fn has_unknown_rows(outcome: &Outcome) -> bool {
    outcome.seeding.rectification.verdict == Verdict::Unknown && outcome.trust < TRUSTED
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_trusted_maps_the_one_that_shows_more_is_better() {
        assert!(!is_as_good((1.0, 0.2), (0.74, 0.85)));
        assert!(is_as_good((0.74, 0.85), (1.0, 0.2)));
        assert!(is_as_good((0.6, 0.3), (0.4, 0.9)) && !is_as_good((0.4, 0.9), (0.6, 0.3)));
        assert!(is_as_good((0.3, 0.5), (0.3, 0.9)));
    }
}
