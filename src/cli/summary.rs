//! The summary of a run that is printed on the terminal.

use hsad::{
    dense::Dense,
    disparity::coverage,
    image::Size,
    pipeline::{RangeSource, RectifiedPair},
    seeding::Verdict,
};

use super::{doubts::span, job::CompletedJob, output::Output, rectification};

/// Smallest share of pixels that is told, 0 to 1: less is 0.0 %.
const LEAST_SHARE: f64 = 0.0005;

impl CompletedJob {
    /// Device, stretch of the samples, range, matches, rectification, trust, coverage and time, one line each.
    pub fn summary(&self) -> String {
        let Self { job, backend, outcome, total, .. } = self;
        let seeding = &outcome.seeding;
        let source = match outcome.range_source {
            RangeSource::Asked => "as asked".into(),
            RangeSource::Found(_) => format!("found from a coarse map and {} matches", seeding.seeds.len()),
            RangeSource::Fallback(_) => "could not be found".into(),
        };
        let rows = match seeding.rectification.verdict {
            Verdict::Rectified => format!("yes: {}", seeding.rectification),
            Verdict::Alignable => format!("nearly: {}", seeding.rectification),
            Verdict::NotRectified | Verdict::UpsideDown | Verdict::Vertical => format!("no: {}", seeding.rectification),
            Verdict::Unknown => seeding.rectification.to_string(),
        };
        let steps: Vec<String> =
            outcome.times.iter().map(|(step, time)| format!("{} {:.2}", step.name(), time.as_secs_f64())).collect();
        let [left, right] = outcome.features.each_ref().map(Vec::len);
        let Size { width, height } = job.left.size();
        let mut text = String::new();
        line(
            &mut text,
            "device",
            match backend.api().as_str() {
                "none" => backend.name(),
                api => format!("{} ({api})", backend.name()),
            },
        );
        if let Some(stretch) = job.stretch {
            line(&mut text, "stretch", format!("{} to {} in the files became 0 to 255", stretch.low, stretch.high));
        }
        line(&mut text, "range", format!("{} ({source})", span(outcome.range)));
        line(&mut text, "points", format!("{left} left, {right} right, {} matched", seeding.seeds.len()));
        text += &self.rectified.as_ref().map(rectified).unwrap_or_default();
        line(&mut text, if self.rectified.is_some() { "rows" } else { "rectified" }, rows);
        line(&mut text, "trust", format!("{:.2} of 1", outcome.trust));
        let share = coverage(&outcome.dense.disparity);
        line(
            &mut text,
            "coverage",
            format!("{} of {width}x{height} pixels{}", percent(share), parts(share, &outcome.dense)),
        );
        if let Some(cloud) = &self.cloud {
            line(&mut text, "cloud", cloud.summary());
        }
        line(&mut text, "time", format!("{:.2} s ({})", total.as_secs_f64(), steps.join(", ")));
        text
    }
}

/// How the pixels with a disparity got it, whose share is `coverage`: of doubtful ones the disparity lies at an end of the range,
/// or the view is constant around the pixel.
fn parts(coverage: f64, dense: &Dense) -> String {
    let (measured, filled) = (dense.measured(), dense.filled());
    let doubtful = coverage - measured - filled;
    match [filled, doubtful].map(|share| share >= LEAST_SHARE) {
        [false, false] => "".into(),
        [true, false] => format!(", {} measured and the rest filled", percent(measured)),
        [false, true] => format!(", {} measured and the rest doubtful", percent(measured)),
        [true, true] => format!(", {} measured, {} filled and the rest doubtful", percent(measured), percent(filled)),
    }
}

/// A share of 0 to 1 in per cent.
fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// What was done to bring rows to correspond, and the size of the pictures.
pub fn rectified(pair: &RectifiedPair) -> String {
    let mut text = String::new();
    line(&mut text, "rectified", rectification::words(pair));
    line(&mut text, "pictures", rectification::pictures(&pair.rectification));
    text
}

/// The line that names the output folder and its files.
pub fn files(output: &Output) -> String {
    let mut text = String::new();
    line(&mut text, "files", format!("{}: {}", hsad::shown(output.folder()), output.names().join(", ")));
    text
}

fn line(text: &mut String, name: &str, value: String) {
    *text += &format!("{name:<11}{value}\n");
}
