//! All doubts about an outcome, and the geometry that holds in spite of them.

use super::{Mirrored, Outcome, RectifiedPair, doubts};
use crate::{
    config::Config,
    io::{Calibration, Picture},
};

/// What is to be said of an outcome.
#[derive(Clone, Debug)]
pub struct Judgement {
    /// The geometry of the disparities, if there is one and nothing tells against it.
    pub calibration: Option<Calibration>,
    /// Doubts, one sentence each; options stand between backticks.
    pub warnings: Vec<String>,
    /// Why the map is not to be trusted; `None` for a map that is, and with [`Config::force`].
    pub not_trusted: Option<String>,
}

impl Judgement {
    /// That of a pair that was matched as it is, by its `calibration`; `mirrored` tells how one view mirrors the other, if it was found out.
    pub fn of_taken(
        outcome: &Outcome,
        views: (&Picture, &Picture),
        calibration: Option<Calibration>,
        config: &Config,
        mirrored: Option<Mirrored>,
    ) -> Self {
        let mut judgement = Self::of_map(outcome, views, None, calibration, config, mirrored);
        if let Some(doubt) = calibration.and_then(|calibration| doubts::looks_to_the_side(outcome, &calibration)) {
            judgement.warnings.push(doubt);
            judgement.calibration = None;
        }
        judgement
    }

    /// That of a pair that was rectified first; `mirrored` tells how one view mirrors the other, if it was found out.
    pub fn of_rectified(outcome: &Outcome, pair: &RectifiedPair, config: &Config, mirrored: Option<Mirrored>) -> Self {
        let ([left, right], calibration) = (&pair.pictures, pair.rectification.calibration().copied());
        let mut judgement = Self::of_map(outcome, (left, right), Some(pair), calibration, config, mirrored);
        judgement.warnings.splice(0..0, doubts::of_rectified(pair).into_iter().chain(doubts::of_lenses(pair)));
        if let Some(doubt) = doubts::misfit(outcome, pair) {
            judgement.warnings.push(doubt);
            judgement.calibration = calibration.filter(|_| config.force);
        }
        judgement
    }

    /// What the map alone tells.
    fn of_map(
        outcome: &Outcome,
        views: (&Picture, &Picture),
        rectified: Option<&RectifiedPair>,
        calibration: Option<Calibration>,
        config: &Config,
        mirrored: Option<Mirrored>,
    ) -> Self {
        let mut not_trusted = doubts::not_trusted(outcome, calibration.as_ref());
        let mut warnings = Vec::new();
        match (mirrored, &mut not_trusted) {
            (Some(sides), Some(reason)) => *reason = doubts::mirrored(sides),
            _ => warnings = doubts::warnings(views, config, outcome, rectified),
        }
        if config.force {
            warnings.extend(not_trusted.take());
        }
        Self { calibration, warnings, not_trusted }
    }
}
