//! The matching job of `hsad match` and `hsad demo`: from two pictures to a disparity map and its warnings.

use std::time::{Duration, Instant};

use anyhow::Result;
use hsad::{
    Backend, Error,
    config::Config,
    dense::View,
    gpu::block_on,
    io::{Calibration, Picture, depth_png::Unheld, load::Stretch},
    pipeline::{self, Mirrored, Outcome, RectifiedPair, TakenPair, WayBack},
    seeding::Verdict,
};

use super::{
    cloud::WrittenCloud,
    doubts::{self, NoDepth, NotTrusted},
    options::RunOptions,
    terminal::Progress,
    way::Way,
};

/// A pair of views and how to match it.
pub struct Job {
    /// Names of the left and the right view, for the report.
    pub names: [String; 2],
    pub left: Picture,
    pub right: Picture,
    /// How the views' samples became 8 bits; `None`: without a stretch.
    pub stretch: Option<Stretch>,
    pub config: Config,
    pub way: Way,
    /// Whether the map of a rectified pair is taken back to the reference view as it was taken.
    pub map_back: bool,
    /// Interest points and matches that a figure shows, the strongest ones; `None`: all.
    pub strongest: Option<usize>,
    /// The geometry of the pair if its pictures are rectified already.
    pub calibration: Option<Calibration>,
}

/// A job with its outcome.
pub struct CompletedJob {
    /// The job, with the pictures that the map belongs to: the rectified ones if the pair was rectified first and the map was not taken
    /// back. Its calibration is that of the disparities.
    pub job: Job,
    pub backend: Backend,
    pub outcome: Outcome,
    /// The pair that was matched, if it was rectified first.
    pub rectified: Option<RectifiedPair>,
    /// The way that the map was taken back, if it was.
    pub back: Option<WayBack>,
    /// Wall-clock time from opening the device to the disparity map.
    pub total: Duration,
    /// Doubts about the result that the output files do not show, one line each.
    pub warnings: Vec<String>,
    /// Why the map is not to be trusted; `None` for a map that is, and with `--force`.
    pub not_trusted: Option<NotTrusted>,
    /// Why there is no depth, if it was asked for; `None` with `--force`.
    pub no_depth: Option<NoDepth>,
    /// What the depth in millimetres lacks, once it was written.
    pub depth_png: Option<Unheld>,
    /// The point cloud, once it was written.
    pub cloud: Option<WrittenCloud>,
}

/// What matching gave, and the rectified pair that was matched, if one was.
struct Matched {
    outcome: Outcome,
    rectified: Option<RectifiedPair>,
    warnings: Vec<String>,
}

impl Job {
    /// Opens the device and matches the pair; writes no files.
    pub fn run(self, options: &RunOptions) -> Result<CompletedJob> {
        let start = Instant::now();
        let cached = options.open()?;
        let completed = self.run_on(&cached.backend, &Progress::new(options.quiet), start)?;
        cached.save();
        Ok(completed)
    }

    /// Matches the pair on an open device, for a job that began at `start`; writes no files.
    pub fn run_on(mut self, backend: &Backend, progress: &Progress, start: Instant) -> Result<CompletedJob> {
        let matched = self.matched(backend, progress);
        let mirrored = self.mirrored(&matched, backend, progress)?;
        let Matched { mut outcome, rectified, mut warnings } = match (matched, mirrored) {
            (Err(_), Some(sides)) => {
                return Err(Error::NotRectifiable { reason: doubts::mirrored(sides) }.into());
            }
            (matched, _) => matched?,
        };
        let given = [&self.left, &self.right];
        let [left, right] = rectified.as_ref().map_or(given, |pair| pair.pictures.each_ref());
        let mut calibration = match &rectified {
            Some(pair) => pair.rectification.calibration().copied(),
            None => self.calibration,
        };
        let mut not_trusted = NotTrusted::new(&outcome, calibration.as_ref());
        match (mirrored, &mut not_trusted) {
            (Some(sides), Some(doubt)) => doubt.reason = doubts::mirrored(sides),
            _ => warnings.extend(doubts::warnings((left, right), &self.config, &outcome)),
        }
        if self.config.force {
            warnings.extend(not_trusted.take().map(|doubt| doubt.reason));
        }
        let (mut back, mut no_depth) = (None, None);
        if let Some(pair) = &rectified {
            if self.map_back {
                let way = pair.way_back(self.config.reference, &outcome.seeding.rectification.rows)?;
                outcome.dense = way.dense(&outcome.dense);
                back = Some(way);
            } else {
                [self.left, self.right] = pair.pictures.clone();
            }
            if calibration.is_none() && self.calibration.is_some() {
                let reason = "no depth and no point cloud: the pair was rectified from its matches, which tell no baseline; the calibration \
                              is that of a rectified pair, and this one is not";
                no_depth = Some(reason.to_string());
            }
        } else if let Some(doubt) =
            calibration.and_then(|calibration| doubts::looks_to_the_side(&outcome, &calibration))
        {
            warnings.push(doubt);
            calibration = None;
        }
        self.calibration = calibration;
        let (backend, total) = (backend.clone(), start.elapsed());
        let mut completed = CompletedJob {
            job: self,
            backend,
            outcome,
            rectified,
            back,
            total,
            warnings,
            not_trusted,
            no_depth: None,
            depth_png: None,
            cloud: None,
        };
        no_depth.into_iter().for_each(|reason| completed.miss_depth(reason));
        Ok(completed)
    }

    /// How one view mirrors the other, which is found out where the pair was refused or its map is not to be trusted.
    fn mirrored(
        &self,
        matched: &Result<Matched>,
        backend: &Backend,
        progress: &Progress,
    ) -> Result<Option<Mirrored>, Error> {
        let is_doubtful = match matched {
            Ok(Matched { outcome, .. }) => outcome.trust < pipeline::TRUSTED && outcome.no_depth.is_none(),
            Err(error) => {
                matches!(error.downcast_ref::<Error>(), Some(Error::NotRectified { .. } | Error::NotRectifiable { .. }))
            }
        };
        if !is_doubtful {
            return Ok(None);
        }
        progress.begin("looking for a mirror image");
        pipeline::mirrored(backend, (&self.left, &self.right))
    }

    fn matched(&self, backend: &Backend, progress: &Progress) -> Result<Matched> {
        let views = (&self.left, &self.right);
        let by = |stereo| {
            progress.begin("rectifying");
            pipeline::rectify_by(backend, views, stereo)
        };
        match &self.way {
            Way::AsIs => Ok(as_taken(self.as_it_is(backend, self.config.force, progress)?)),
            Way::AsNeeded => self.as_needed(backend, progress),
            Way::Uncalibrated => {
                progress.begin("rectifying");
                self.along_rows_of(pipeline::rectify(backend, views)?, backend, progress)
            }
            Way::Calibrated(stereo) => self.along_rows_of(by(stereo)?, backend, progress),
            Way::Either(_) if !self.config.align => self.as_needed(backend, progress),
            Way::Either(stereo) => {
                let pair = by(stereo)?;
                if !pair.is_better_than_taken() {
                    return self.as_needed(backend, progress);
                }
                let mut matched = self.along_rows_of(pair, backend, progress)?;
                matched.warnings.push(
                    "the calibration is of pictures as they were taken and of rectified ones: these were rectified by it, since their \
                     rows correspond better then; --rectify never takes them as rectified"
                        .into(),
                );
                Ok(matched)
            }
        }
    }

    fn as_it_is(&self, backend: &Backend, force: bool, progress: &Progress) -> Result<Outcome, Error> {
        block_on(pipeline::run_with_progress(
            backend,
            (&self.left, &self.right),
            &Config { force, ..self.config.clone() },
            |step| progress.step(step),
            |share| progress.share(share),
        ))
    }

    /// As [`Self::as_it_is`]; `None` if the lens distorts the rows, which no warp of the rows of one view mends, and nothing is lost
    /// by a rectification: without a calibration.
    fn as_it_is_unless_distorted(&self, backend: &Backend, progress: &Progress) -> Result<Option<Outcome>, Error> {
        block_on(pipeline::run_unless(
            backend,
            (&self.left, &self.right),
            &Config { force: false, ..self.config.clone() },
            |rows| rows.is_distorted() && self.calibration.is_none(),
            |step| progress.step(step),
            |share| progress.share(share),
        ))
    }

    /// Matches a rectified pair.
    fn along_rows_of(&self, pair: RectifiedPair, backend: &Backend, progress: &Progress) -> Result<Matched> {
        let outcome = block_on(pipeline::run_rectified(
            backend,
            &pair,
            &self.config,
            |step| progress.step(step),
            |share| progress.share(share),
        ));
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
        let warnings = doubts::of_rectified(&pair).into_iter().collect();
        Ok(Matched { outcome, rectified: Some(pair), warnings })
    }

    /// Matches the pair as it is, or rectified from its matches if its rows do not correspond.
    ///
    /// With [`Config::force`], or without [`Config::align`], a pair that cannot be rectified, or must not be, is matched or refused
    /// as with [`Way::AsIs`].
    fn as_needed(&self, backend: &Backend, progress: &Progress) -> Result<Matched> {
        let force = self.config.force;
        if !self.config.align {
            return Ok(as_taken(self.as_it_is(backend, force, progress)?));
        }
        let looked = self.first_look(backend, progress)?;
        let as_is = match looked.as_ref().and_then(TakenPair::rows) {
            Some(rows) if rows.is_distorted() => Ok(None),
            Some(rows) => Err(Error::NotRectified { diagnosis: rows.to_string() }),
            None => self.as_it_is_unless_distorted(backend, progress),
        };
        let why = match &as_is {
            Err(error @ Error::SizesDiffer { .. }) => error.to_string(),
            Err(Error::NotRectified { diagnosis }) => format!("the pair is not rectified: {diagnosis}"),
            Ok(None) => "the lens distorts the pictures".into(),
            Ok(Some(outcome)) if has_unknown_rows(outcome) => {
                "nothing tells whether the rows of the views correspond".into()
            }
            _ => {
                return match as_is? {
                    Some(outcome) if self.can_lean() && has_leaning_columns(&outcome) => {
                        self.with_upright_columns(outcome, backend, progress)
                    }
                    outcome => self.taken_or(outcome, backend, progress),
                };
            }
        };
        progress.begin("rectifying");
        let was_looked_at = looked.is_some();
        let pair = match looked {
            Some(pair) => pair.rectify(backend),
            None => pipeline::rectify(backend, (&self.left, &self.right)),
        };
        let refused = match pair {
            Ok(pair) if matches!(as_is, Ok(None)) && pair.rectification.distortion() == 0.0 => {
                return Ok(as_taken(self.as_it_is(backend, force, progress)?));
            }
            Ok(pair) => {
                let mut matched = self.along_rows_of(pair, backend, progress)?;
                matched
                    .warnings
                    .insert(0, format!("{why}; disparities are those of the pair rectified from its matches"));
                return Ok(matched);
            }
            Err(Error::NotRectifiable { reason }) => reason,
            Err(error) => return Err(error.into()),
        };
        let as_is = if was_looked_at { self.as_it_is_unless_distorted(backend, progress) } else { as_is };
        let outcome = match as_is {
            Err(Error::NotRectified { .. }) if force => self.as_it_is(backend, true, progress)?,
            Err(Error::NotRectified { diagnosis }) => {
                let diagnosis = format!("no warp that matches tell helps, since {refused}; {diagnosis}");
                return Err(Error::NotRectified { diagnosis }.into());
            }
            Err(Error::SizesDiffer { left, right }) => {
                let reason = format!("{refused} (the left view is {left} and the right view {right} pixels)");
                return Err(Error::NotRectifiable { reason }.into());
            }
            as_is => return self.taken_or(as_is?, backend, progress),
        };
        Ok(as_taken(outcome))
    }

    /// The pair, if a first look tells that it is not to be matched as it was taken: rows differ by more than a small warp mends, or the
    /// lens distorts them. With a calibration, which is of a rectified pair then, nobody looks.
    fn first_look(&self, backend: &Backend, progress: &Progress) -> Result<Option<TakenPair>> {
        if self.calibration.is_some() {
            return Ok(None);
        }
        progress.begin("rectifying");
        let pair = TakenPair::new(backend, (&self.left, &self.right))?;
        let is_unfit = pair.rows().is_some_and(|rows| rows.is_distorted() || rows.rows_differ());
        Ok(is_unfit.then_some(pair))
    }

    /// The outcome of the pair as it was taken, if it was matched; else it is matched now.
    fn taken_or(&self, outcome: Option<Outcome>, backend: &Backend, progress: &Progress) -> Result<Matched> {
        Ok(as_taken(match outcome {
            Some(outcome) => outcome,
            None => self.as_it_is(backend, self.config.force, progress)?,
        }))
    }

    /// Whether the pair may be matched with the columns of the right view upright: a range that was asked for is one of the columns as
    /// they are, and the map of the right view is too.
    fn can_lean(&self) -> bool {
        self.config.range.is_none() && self.config.least.is_none() && self.config.reference == View::Left
    }

    /// The map found with the columns of the right view upright, if it deserves as much trust as that of the columns as they are;
    /// disparities are those of the pair as it was taken.
    fn with_upright_columns(&self, as_is: Outcome, backend: &Backend, progress: &Progress) -> Result<Matched> {
        progress.begin("rectifying");
        let pair = match pipeline::rectify(backend, (&self.left, &self.right)) {
            Ok(pair) => pair,
            Err(Error::NotRectifiable { .. }) => return Ok(as_taken(as_is)),
            Err(error) => return Err(error.into()),
        };
        let upright = self.along_rows_of(pair, backend, progress)?;
        let restored = upright.rectified.and_then(|pair| pair.restored(&as_is, &upright.outcome));
        Ok(as_taken(restored.filter(|restored| restored.trust >= as_is.trust).unwrap_or(as_is)))
    }
}

/// Whether most surfaces of a map share a slant, as where the columns of the right view lean.
fn has_leaning_columns(outcome: &Outcome) -> bool {
    outcome.seeding.rectification.lean != 0.0 && outcome.no_depth.is_none()
}

/// The outcome of a pair that was matched as it was taken.
fn as_taken(outcome: Outcome) -> Matched {
    Matched { outcome, rectified: None, warnings: Vec::new() }
}

/// Whether a map is not to be trusted since nothing tells whether rows correspond.
fn has_unknown_rows(outcome: &Outcome) -> bool {
    outcome.seeding.rectification.verdict == Verdict::Unknown && outcome.trust < pipeline::TRUSTED
}
