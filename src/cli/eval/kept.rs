//! Results of an earlier run that still hold.

use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::Path,
    time::SystemTime,
};

use hsad::{Error, Result};
use serde_json::{Value, json};

use crate::cli::output::Output;

/// The file that keeps a result, next to its pictures if it has any.
const NAME: &str = "result.json";

/// A number for all that a result depends on. The standard library's hash may be another one in another release of the
/// compiler, but then the program is another one, too.
#[derive(Clone, Debug)]
pub struct Fingerprint(DefaultHasher);

impl Fingerprint {
    /// Of this very build of the program: whoever works on it must not be shown what another build found.
    pub fn of_program() -> Self {
        let mut hasher = DefaultHasher::new();
        env!("CARGO_PKG_VERSION").hash(&mut hasher);
        match std::env::current_exe().and_then(fs::read) {
            Ok(bytes) => bytes.hash(&mut hasher),
            // It was replaced since it started: whatever was kept is not known to be of the same build.
            Err(_) => (std::process::id(), SystemTime::now()).hash(&mut hasher),
        }
        Self(hasher)
    }

    /// The same with a text.
    #[must_use]
    pub fn with(mut self, text: &str) -> Self {
        text.hash(&mut self.0);
        self
    }

    /// The same with what a file holds.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read.
    pub fn with_file(mut self, path: &Path) -> Result<Self> {
        fs::read(path).map_err(|source| Error::Io { path: path.into(), source })?.hash(&mut self.0);
        Ok(self)
    }

    fn text(&self) -> String {
        format!("{:016x}", self.0.finish())
    }
}

/// The result in `folder`, if its files are there and it has this fingerprint.
pub fn find(folder: &Path, fingerprint: &Fingerprint) -> Option<Value> {
    let kept: Value = serde_json::from_str(&fs::read_to_string(folder.join(NAME)).ok()?).ok()?;
    let is_there = |file: &Value| file.as_str().is_some_and(|name| folder.join(name).is_file());
    let holds = kept["fingerprint"] == fingerprint.text() && kept["files"].as_array()?.iter().all(is_there);
    holds.then_some(kept)
}

/// Adds a result, an object, to the files of `output`.
///
/// # Errors
/// [`Error::Io`] with the file.
pub fn add(output: &mut Output, mut kept: Value, fingerprint: &Fingerprint) -> Result<()> {
    kept["fingerprint"] = fingerprint.text().into();
    kept["files"] = json!(output.names());
    output.add_json(NAME, &kept)
}
