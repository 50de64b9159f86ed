//! Figures of an earlier run.

use std::{collections::BTreeMap, path::Path};

use anyhow::{anyhow, bail};
use hsad::io::read_whole;
use serde_json::Value;

use super::case::Case;

/// Longest file that is read, in bytes: devices have no end.
const MOST: u64 = 1 << 26;

/// Medians of an earlier run, by the names of the cases.
pub struct Earlier(BTreeMap<String, f64>);

impl Earlier {
    /// Reads the JSON of `hsad bench`, of which at least one case must be among `wanted`.
    pub fn read(file: &Path, wanted: &[Case]) -> anyhow::Result<Self> {
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
        let known: BTreeMap<_, _> = cases.iter().map(|one| case(one).ok_or_else(unknown)).collect::<Result<_, _>>()?;
        if wanted.iter().any(|case| known.contains_key(&case.name())) {
            return Ok(Self(known));
        }
        let names: Vec<_> = known.into_keys().collect();
        bail!(
            "{} has no case of this run, so that nothing can be compared: it has {} (preset, size and number of disparities)",
            hsad::shown(file),
            if names.is_empty() { "none".into() } else { names.join(", ") }
        )
    }

    /// The median of the case of this name, in milliseconds.
    pub fn median(&self, case: &str) -> Option<f64> {
        self.0.get(case).copied()
    }
}
