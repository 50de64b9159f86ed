//! `report.json`: parameters, figures and times of a run, for programs.

use hsad::{
    config::Config,
    disparity::DisparityMap,
    io::{disparity_png::Encoding, load::Stretch},
    report,
};
use serde_json::{Value, json};

use super::{cloud::WrittenCloud, job::CompletedJob};

pub use hsad::report::{device, searched};

impl CompletedJob {
    /// The report without the list of files.
    pub fn report(&self) -> Value {
        let Self { job, backend, outcome, rectified, back, total, warnings, not_trusted, cloud } = self;
        let stretched = |Stretch { low, high }| json!({ "low": report::number(low), "high": report::number(high) });
        let mut value = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "left": job.names[0],
            "right": job.names[1],
            "width": job.left.width(),
            "height": job.left.height(),
            "stretch": job.stretch.map(stretched),
            "device": device(backend),
            "calibration": job.calibration.as_ref().map(report::calibration),
            "cloud": cloud.as_ref().map(WrittenCloud::report),
            "rectified": rectified.as_ref().map(report::rectified),
            "mapped_back": back.is_some(),
            "not_trusted": not_trusted.as_ref().map(|doubt| &doubt.reason),
            "disparity_png": disparity_png(&outcome.dense.disparity),
            "warnings": warnings,
        });
        for (name, figure) in report::outcome(&job.config, outcome) {
            value[name] = figure;
        }
        value["parameters"] = parameters(&job.config, job.strongest);
        value["seconds"]["total"] = json!(total.as_secs_f64());
        value
    }
}

/// All parameters of the configuration, and how many interest points and matches a figure shows.
pub fn parameters(config: &Config, strongest: Option<usize>) -> Value {
    let mut parameters = report::parameters(config);
    parameters["strongest"] = json!(strongest);
    parameters
}

/// How the values of `disparity.png` become disparities: times the one, plus the other.
fn disparity_png(map: &DisparityMap) -> Value {
    let encoding = Encoding::of(map);
    json!({ "px_per_value": encoding.px_per_value(), "offset_px": encoding.offset })
}
