//! The results of earlier runs in the output folder.

use std::path::Path;

use anyhow::{Result, bail};
use hsad::{io::read_whole, shown};
use serde_json::Value;

use super::{
    super::{earlier_set::UNFINISHED, names::REPORT},
    frame::Frame,
    inputs::{Other, Recorded},
    pair::Pair,
};

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

    /// The report of the results under the name of `pair`, and their inputs, if all of their files are there.
    ///
    /// # Errors
    /// Results of other inputs than the pair has now, which are not replaced: they may be those of another batch, or of another journal.
    pub fn of(&self, pair: &Pair, frame: Option<&Frame>) -> Result<Option<(Value, Recorded)>> {
        let Some(report) = self.report(&pair.name) else { return Ok(None) };
        let (name, folder) = (shown(Path::new(&pair.name)), shown(&self.folder.join(&pair.name)));
        let ways_out = format!("Remove the folder {folder} to match the pair again, or name another folder (-o)");
        let Some(inputs) = Recorded::of(&report) else {
            bail!("the results '{name}' of this folder do not tell their inputs: no batch has made them. {ways_out}");
        };
        match inputs.other_input(pair, frame) {
            None => Ok(Some((report, inputs))),
            Some(Other { path, is_gone: true }) => bail!(
                "the results '{name}' of this folder may be of other inputs: {} is gone. Bring it back, or name another folder (-o)",
                shown(&path)
            ),
            Some(Other { path, .. }) => bail!(
                "the results '{name}' of this folder are of other inputs: {} has changed or is another one. {ways_out}",
                shown(&path)
            ),
        }
    }

    /// The report of the results of this name, of whatever inputs, if all of their files are there, and of one set.
    fn report(&self, name: &str) -> Option<Value> {
        let folder = self.folder.join(name);
        let path = folder.join(REPORT);
        if !path.is_file() {
            return None;
        }
        let report: Value = serde_json::from_slice(&read_whole(&path, MOST).ok()?).ok()?;
        let files = report["files"].as_array().filter(|_| report[UNFINISHED] != true)?;
        let are_there = files.iter().all(|file| file.as_str().is_some_and(|name| folder.join(name).is_file()));
        are_there.then_some(report)
    }
}
