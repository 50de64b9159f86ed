//! Figures of an earlier run.

use std::{collections::BTreeMap, path::Path};

use anyhow::anyhow;
use hsad::io::read_whole;
use serde_json::Value;

/// Longest file that is read, in bytes: devices have no end.
const MOST: u64 = 1 << 26;

/// Medians of an earlier run, by the names of the cases.
pub struct Earlier(BTreeMap<String, f64>);

impl Earlier {
    /// Reads the JSON of `hsad bench`.
    pub fn read(file: &Path) -> anyhow::Result<Self> {
        let bytes = read_whole(file, MOST)?;
        let unknown = || anyhow!("{}: no figures of hsad bench --json", hsad::shown(file));
        let report: Value = serde_json::from_slice(&bytes).map_err(|_| unknown())?;
        let case = |case: &Value| {
            let number = |name: &str| case[name].as_u64();
            let (width, height) = (number("width")?, number("height")?);
            let name = format!("{} {width}x{height} {}", case["preset"].as_str()?, number("disparities")?);
            Some((name, case["median_ms"].as_f64().filter(|median| *median > 0.0)?))
        };
        let cases = report["cases"].as_array().ok_or_else(unknown)?;
        cases.iter().map(|one| case(one).ok_or_else(unknown)).collect::<Result<_, _>>().map(Self)
    }

    /// The median of the case of this name, in milliseconds.
    pub fn median(&self, case: &str) -> Option<f64> {
        self.0.get(case).copied()
    }
}
