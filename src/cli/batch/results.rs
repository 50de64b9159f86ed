//! The results of earlier runs in the output folder.

use std::path::Path;

use hsad::io::read_whole;
use serde_json::Value;

use super::{super::names::REPORT, pair::Pair, record::is_of};

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
    /// The report of the results of `pair`, if all of its files are there, and are those of this batch.
    pub fn report_of(&self, pair: &Pair) -> Option<Value> {
        let folder = self.folder.join(&pair.name);
        let path = folder.join(REPORT);
        if !self.resumes || !path.is_file() {
            return None;
        }
        let report: Value = serde_json::from_slice(&read_whole(&path, MOST).ok()?).ok()?;
        let files = report["files"].as_array()?;
        let are_there = files.iter().all(|file| file.as_str().is_some_and(|name| folder.join(name).is_file()));
        (are_there && is_of(&report, pair) && report["parameters"] == self.parameters).then_some(report)
    }
}
