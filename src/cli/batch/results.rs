//! The results of earlier runs in the output folder.

use std::path::Path;

use hsad::io::read_whole;
use serde_json::Value;

use super::{super::names::REPORT, frame::Frame, inputs::Recorded, pair::Pair};

/// Longest report that is read, in bytes.
const MOST: u64 = 1 << 26;

/// Where the results of all pairs are.
pub struct Results<'a> {
    /// The output folder.
    pub folder: &'a Path,
    /// Whether an earlier run of this batch may have left results.
    pub resumes: bool,
    /// The parameters as a report has them.
    pub parameters: Value,
}

impl Results<'_> {
    /// The report of the results of `pair`, if all of its files are there, and were made as this batch makes them of the inputs that the
    /// pair has now.
    pub fn report_of(&self, pair: &Pair, frame: Option<&Frame>) -> Option<Value> {
        let report = self.report(&pair.name).filter(|report| self.resumes && self.are_of_batch(report))?;
        Recorded::of(&report)?.other_input(pair, frame).is_none().then_some(report)
    }

    /// Whether the results of this report were made as this batch makes them.
    pub fn are_of_batch(&self, report: &Value) -> bool {
        report["parameters"] == self.parameters
    }

    /// The report of the results of this name, of whatever inputs, if all of their files are there.
    pub fn report(&self, name: &str) -> Option<Value> {
        let folder = self.folder.join(name);
        let path = folder.join(REPORT);
        if !path.is_file() {
            return None;
        }
        let report: Value = serde_json::from_slice(&read_whole(&path, MOST).ok()?).ok()?;
        let files = report["files"].as_array()?;
        let are_there = files.iter().all(|file| file.as_str().is_some_and(|name| folder.join(name).is_file()));
        are_there.then_some(report)
    }
}
