//! The matching job of `hsad match` and `hsad demo`: from two pictures to a disparity map and its warnings.

use std::time::{Duration, Instant};

use anyhow::Result;
use hsad::{
    Backend,
    config::Config,
    io::{Calibration, Picture, depth_png::Unheld, load::Stretch},
    pipeline::{Judgement, Matched, Outcome, Precedent, RectifiedPair, Task, Way, WayBack},
};

use super::{
    cloud::WrittenCloud,
    doubts::{NoDepth, NotTrusted},
    options::RunOptions,
    terminal::Progress,
    wording::in_words_of_options,
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
    /// Whether the pair was matched by the precedent of an earlier frame.
    pub follows: bool,
    /// What the pair tells the frames after it.
    pub precedent: Option<Precedent>,
}

impl Job {
    /// Opens the device and matches the pair; writes no files.
    pub fn run(self, options: &RunOptions) -> Result<CompletedJob> {
        let start = Instant::now();
        let cached = options.open()?;
        let completed = self.run_on(&cached.backend, None, &Progress::new(options.quiet), start)?;
        cached.save();
        Ok(completed)
    }

    /// Matches the pair on an open device, as a frame after a `precedent` if there is one, for a job that began at `start`; writes no files.
    pub fn run_on(
        mut self,
        backend: &Backend,
        precedent: Option<&Precedent>,
        progress: &Progress,
        start: Instant,
    ) -> Result<CompletedJob> {
        let matched = Task {
            backend,
            views: (&self.left, &self.right),
            config: &self.config,
            way: &self.way,
            calibration: self.calibration,
            precedent,
            begin: &|activity| progress.activity(activity),
            progress: &|share| progress.share(share),
        }
        .run()?;
        let precedent = matched.precedent((&self.left, &self.right));
        let Matched { mut outcome, rectified, judgement, follows } = matched;
        let Judgement { calibration, warnings, not_trusted } = judgement;
        let warnings: Vec<String> = warnings.iter().map(|warning| in_words_of_options(warning)).collect();
        let not_trusted = not_trusted.map(|reason| NotTrusted { reason });
        let (mut back, mut no_depth) = (None, None);
        if let Some(pair) = &rectified {
            if self.map_back {
                let way = pair.way_back(self.config.reference, &outcome.seeding.rectification.rows)?;
                outcome.dense = way.dense(&outcome.dense);
                back = Some(way);
            } else {
                [self.left, self.right] = pair.pictures.clone();
            }
        }
        let is_by_calibration = rectified.as_ref().is_some_and(|pair| pair.rectification.calibration().is_some());
        if calibration.is_none() && (self.calibration.is_some() || is_by_calibration) {
            let reason = match &rectified {
                Some(_) if is_by_calibration => {
                    "no depth and no point cloud: the calibration does not fit the pictures, as the rows of the rectified pair tell"
                }
                Some(_) => {
                    "no depth and no point cloud: the pair was rectified from its matches, which tell no baseline; the calibration is that \
                     of a rectified pair, and this one is not"
                }
                None => {
                    "no depth and no point cloud: the calibration is that of a rectified pair, and the rows of this one say otherwise"
                }
            };
            no_depth = Some(reason.to_string());
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
            follows,
            precedent,
        };
        no_depth.into_iter().for_each(|reason| completed.miss_depth(reason));
        Ok(completed)
    }
}
