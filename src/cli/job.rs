//! The matching job of `hsad match` and `hsad demo`: from two pictures to a disparity map and its warnings.

use std::time::{Duration, Instant};

use anyhow::Result;
use hsad::{
    Backend, Error,
    config::Config,
    disparity::DisparityRange,
    io::{Calibration, Picture, load::Stretch},
    pipeline::{self, Outcome, RangeSource},
};

use super::{options::RunOptions, terminal::Progress, wording::in_options};

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
}

impl Job {
    /// Opens the device and matches the pair; writes no files.
    pub fn run(self, options: &RunOptions) -> Result<CompletedJob> {
        let start = Instant::now();
        let backend = options.open()?;
        let progress = Progress::new(options.quiet);
        let views = (&self.left, &self.right);
        let outcome = pipeline::run(&backend, views, &self.config, |step| progress.step(step))?;
        let warnings = warnings(views, &self.config, &outcome);
        Ok(CompletedJob { job: self, backend, outcome, total: start.elapsed(), warnings })
    }
}

/// Trust below which a result gets a warning, 0 to 1; sound rectified pairs reach twice this value.
const LITTLE_TRUST: f32 = 0.25;

/// Warnings about a result: identical views, a guessed or cut disparity range, little trust, a distorted lens, matches
/// outside the range,
/// and a difference in brightness.
pub fn warnings((left, right): (&Picture, &Picture), config: &Config, outcome: &Outcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if left == right {
        warnings.push("both views are the same picture, which shows no depth".into());
    }
    if let RangeSource::Fallback(thin) = outcome.range_source {
        let reason = in_options(&Error::from(thin));
        warnings.push(format!("{reason}; {} were searched instead", span(outcome.range)));
    }
    if let Some(asked) = config.range.filter(|&asked| asked != outcome.range) {
        let reason = "no pixel has a partner further away than the picture is wide";
        warnings.push(format!("{} were searched, not {}: {reason}", span(outcome.range), span(asked)));
    }
    // Without a range found from the matches the trust is 0 by definition, not by evidence.
    if outcome.seeding.range.is_ok() && outcome.trust < LITTLE_TRUST {
        warnings
            .push(format!("hardly any matching interest points support this result (trust {:.2} of 1)", outcome.trust));
    }
    warnings.extend(distortion(outcome));
    warnings.extend(outside(outcome));
    warnings.extend(brightness(outcome));
    warnings
}

/// A disparity range as text, `MIN to MAX px`.
pub fn span(range: DisparityRange) -> String {
    format!("{} to {} px", range.min, range.last())
}

/// A warning if rows differ as the rows of a distorted lens do.
fn distortion(outcome: &Outcome) -> Option<String> {
    let rows = &outcome.seeding.rectification;
    rows.is_distorted().then(|| {
        format!(
            "rows are off by up to {:.1} px in parts of the picture, as by a distorted lens: remove the distortion from \
             both pictures first",
            rows.unexplained
        )
    })
}

/// A warning if most matches lie outside the searched range, or have negative disparities: the range is wrong, or the
/// views are exchanged.
fn outside(outcome: &Outcome) -> Option<String> {
    let disparities: Vec<f32> = outcome.seeding.seeds.iter().map(|seed| seed.disparity).collect();
    let share = |wanted: &dyn Fn(f32) -> bool| {
        disparities.iter().filter(|&&disparity| wanted(disparity)).count() as f32 / disparities.len() as f32
    };
    let least = disparities.iter().copied().reduce(f32::min)?;
    let most = disparities.iter().copied().reduce(f32::max)?;
    let within = share(&|disparity| outcome.range.contains(disparity.round() as i32));
    let negative = share(&|disparity| disparity < 0.0);
    let mixed_up = "if left and right are mixed up, exchange them";
    if within < 0.5 {
        let (percent, range) = (100.0 * within, span(outcome.range));
        let advice = match outcome.range_source {
            _ if negative > 0.5 => mixed_up,
            RangeSource::Asked => "leave --disparities out to have the range found",
            _ => "lower --min-disparity",
        };
        Some(format!(
            "only {percent:.0} % of the matches lie in {range}, their disparities are {least:.0} to {most:.0} px: {advice}"
        ))
    } else if negative > 0.75 {
        Some(format!("disparities are {least:.0} to {most:.0} px, mostly negative: {mixed_up}"))
    } else {
        None
    }
}

/// A warning if the views differ notably in brightness, which absolute differences suffer from.
fn brightness(outcome: &Outcome) -> Option<String> {
    /// Difference in grey values that most pairs from two cameras of one kind stay below.
    const NOTABLE: f32 = 8.0;
    let found = outcome.seeding.brightness?;
    let difference = |grey: f32| found.gain * grey + found.offset - grey;
    let largest = [64.0, 192.0].map(difference).into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let word = if largest > 0.0 { "brighter" } else { "darker" };
    (largest.abs() > NOTABLE).then(|| {
        format!(
            "the right view is up to {:.0} grey values {word} than the left (x {:.2} {:+.0}): take both with one \
             exposure for a better result",
            largest.abs(),
            found.gain,
            found.offset
        )
    })
}
