//! The summary of a run that is printed on the terminal.

use hsad::{
    disparity::coverage,
    image::Size,
    pipeline::{RangeSource, RectifiedPair},
    seeding::Verdict,
};

use super::{doubts::span, job::CompletedJob, output::Output, rectification};

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
        let share = 100.0 * coverage(&outcome.dense.disparity);
        let measured = 100.0 * outcome.dense.measured();
        let filled =
            if measured < share { format!(", {measured:.1} % measured and the rest filled") } else { "".into() };
        line(&mut text, "coverage", format!("{share:.1} % of {width}x{height} pixels{filled}"));
        line(&mut text, "time", format!("{:.2} s ({})", total.as_secs_f64(), steps.join(", ")));
        text
    }
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
    line(&mut text, "files", format!("{}: {}", output.folder().display(), output.names().join(", ")));
    text
}

fn line(text: &mut String, name: &str, value: String) {
    *text += &format!("{name:<11}{value}\n");
}
