//! `report.json`: parameters, figures and times of a run, for programs.

use hsad::{
    config::Config,
    report::{self, Run},
};
use serde_json::{Value, json};

use super::job::CompletedJob;

pub use hsad::report::{device, searched};

impl CompletedJob {
    /// The report without the list of files.
    pub fn report(&self) -> Value {
        let Self {
            job,
            backend,
            outcome,
            rectified,
            back,
            total,
            warnings,
            not_trusted,
            no_depth,
            depth_png,
            cloud,
            ..
        } = self;
        let mut value = report::run(&Run {
            names: job.names.each_ref().map(String::as_str),
            size: job.left.size(),
            stretch: job.stretch,
            backend,
            calibration: job.calibration.as_ref(),
            cloud: cloud.as_ref().map(|cloud| &cloud.0),
            depth_png: *depth_png,
            rectified: rectified.as_ref(),
            mapped_back: back.is_some(),
            no_depth: no_depth.as_ref().map(|missing| missing.reason.as_str()),
            not_trusted: not_trusted.as_ref().map(|doubt| doubt.reason.as_str()),
            warnings,
            config: &job.config,
            outcome,
            total: *total,
        });
        value["parameters"] = parameters(&job.config, job.strongest);
        if self.follows {
            value["follows"] = true.into();
        }
        value
    }
}

/// All parameters of the configuration, and how many interest points and matches a figure shows.
pub fn parameters(config: &Config, strongest: Option<usize>) -> Value {
    let mut parameters = report::parameters(config);
    parameters["strongest"] = json!(strongest);
    parameters
}
