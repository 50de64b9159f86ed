//! The main job: a pair on a device, from pictures to a disparity map, and what is odd about it.

use std::time::{Duration, Instant};

use anyhow::Result;
use hsad::{
    Error,
    config::Config,
    disparity::DisparityRange,
    io::{Calibration, Picture},
    pair::Backend,
    pipeline::{self, Outcome, RangeSource},
};

use super::{options::RunOptions, terminal::Progress};

/// A pair and what is asked about it.
pub struct Job {
    /// What left and right view are called.
    pub names: [String; 2],
    pub left: Picture,
    pub right: Picture,
    pub config: Config,
    pub calibration: Option<Calibration>,
}

/// A job and what came out.
pub struct CompletedJob {
    pub job: Job,
    pub backend: Backend,
    pub outcome: Outcome,
    /// From opening the device to the disparity map.
    pub total: Duration,
    /// What the files do not show by themselves, a line each.
    pub warnings: Vec<String>,
}

impl Job {
    /// Computes everything and writes nothing.
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

/// Pairs that are what they should be have twice as much.
const LITTLE_TRUST: f32 = 0.25;

/// What someone should know before they use the result.
pub fn warnings((left, right): (&Picture, &Picture), config: &Config, outcome: &Outcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if left == right {
        warnings.push("both views are the same picture, which shows no depth".into());
    }
    if let RangeSource::Fallback(thin) = outcome.range_source {
        warnings.push(format!("{}; {} were searched instead", Error::from(thin), span(outcome.range)));
    }
    if let Some(asked) = config.range.filter(|&asked| asked != outcome.range) {
        let reason = "no pixel has a partner further away than the picture is wide";
        warnings.push(format!("{} were searched, not {}: {reason}", span(outcome.range), span(asked)));
    }
    // Without a range of their own, matches say nothing about trust.
    if outcome.seeding.range.is_ok() && outcome.seeding.trust < LITTLE_TRUST {
        warnings.push(format!(
            "hardly any matching interest points support this result (trust {:.2} of 1)",
            outcome.seeding.trust
        ));
    }
    warnings.extend(outside(outcome));
    warnings.extend(brightness(outcome));
    warnings
}

/// The disparities of a range, for people.
pub fn span(range: DisparityRange) -> String {
    format!("{} to {} px", range.min, range.last())
}

/// Matches that the search could not have found tell of a range that is wrong, or of views mixed up.
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
            "only {percent:.0} % of the matches lie in {range}, theirs are {least:.0} to {most:.0} px: {advice}"
        ))
    } else if negative > 0.75 {
        Some(format!("disparities are {least:.0} to {most:.0} px, mostly negative: {mixed_up}"))
    } else {
        None
    }
}

/// Absolute differences suffer where the views differ in brightness.
fn brightness(outcome: &Outcome) -> Option<String> {
    /// A difference that most pairs from two cameras of one kind stay below, in grey values.
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
