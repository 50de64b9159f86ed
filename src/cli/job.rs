//! The matching job of `hsad match` and `hsad demo`: from two pictures to a disparity map and its warnings.

use std::time::{Duration, Instant};

use anyhow::Result;
use hsad::{
    Backend,
    config::Config,
    gpu::block_on,
    io::{Calibration, Picture, load::Stretch},
    pipeline::{self, Outcome},
};

use super::{
    doubts::{self, NotTrusted},
    options::RunOptions,
    terminal::Progress,
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
    /// Interest points and matches that a figure shows, the strongest ones; `None`: all.
    pub strongest: Option<usize>,
    pub calibration: Option<Calibration>,
}

/// A job with its outcome.
pub struct CompletedJob {
    pub job: Job,
    pub backend: Backend,
    pub outcome: Outcome,
    /// Wall-clock time from opening the device to the disparity map.
    pub total: Duration,
    /// Doubts about the result that the output files do not show, one line each.
    pub warnings: Vec<String>,
    /// Why the map is not to be trusted; `None` for a map that is, and with `--force`.
    pub not_trusted: Option<NotTrusted>,
}

impl Job {
    /// Opens the device and matches the pair; writes no files.
    pub fn run(self, options: &RunOptions) -> Result<CompletedJob> {
        let start = Instant::now();
        let cached = options.open()?;
        let progress = Progress::new(options.quiet);
        let views = (&self.left, &self.right);
        let outcome = block_on(pipeline::run_with_progress(
            &cached.backend,
            views,
            &self.config,
            |step| progress.step(step),
            |share| progress.share(share),
        ))?;
        cached.save();
        let mut warnings = doubts::warnings(views, &self.config, &outcome);
        let mut not_trusted = NotTrusted::new(&outcome);
        if self.config.force {
            warnings.extend(not_trusted.take().map(|doubt| doubt.reason));
        }
        let (backend, total) = (cached.backend, start.elapsed());
        Ok(CompletedJob { job: self, backend, outcome, total, warnings, not_trusted })
    }
}
