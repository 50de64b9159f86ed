//! Results that outlast a run, so that a long one can be interrupted and taken up again.

use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
    time::SystemTime,
};

use hsad::{Error, Result};
use serde_json::Value;

use crate::cli::output::Output;

/// The file that keeps a result, next to its pictures if it has any.
const NAME: &str = "result.json";

/// A result that can be location.
pub trait Saveable: Sized {
    /// An object, for [`Self::from_json`].
    fn to_json(&self) -> Value;

    /// What [`Self::to_json`] made; `None` where something is missing.
    fn from_json(value: &Value) -> Option<Self>;
}

/// Where results are kept, if they are, and all that they depend on.
#[derive(Clone, Debug)]
pub struct SavedResults(Option<Location>);

#[derive(Clone, Debug)]
struct Location {
    folder: PathBuf,
    /// Of all that the results depend on. The standard library's hash may be another one in another release of the
    /// compiler, but then the program is another one, too.
    fingerprint: DefaultHasher,
    /// Whether results of an earlier run are passed over.
    fresh: bool,
}

impl SavedResults {
    /// Keeps the results of this very build of the program below `folder`: whoever works on it must not be shown what
    /// another build found. Without a folder nothing is kept; where `fresh`, nothing is found.
    pub fn new(folder: Option<&Path>, fresh: bool) -> Self {
        Self(folder.map(|folder| {
            let mut fingerprint = DefaultHasher::new();
            env!("CARGO_PKG_VERSION").hash(&mut fingerprint);
            match std::env::current_exe().and_then(fs::read) {
                Ok(bytes) => bytes.hash(&mut fingerprint),
                // It was replaced since it started: whatever was kept is not known to be of the same build.
                Err(_) => (std::process::id(), SystemTime::now()).hash(&mut fingerprint),
            }
            Location { folder: folder.into(), fingerprint, fresh }
        }))
    }

    /// The folder `name` in this one.
    #[must_use]
    pub fn below(mut self, name: &str) -> Self {
        if let Some(location) = &mut self.0 {
            location.folder.push(name);
        }
        self
    }

    /// The same for results that also depend on a text.
    #[must_use]
    pub fn depending_on(mut self, text: &str) -> Self {
        if let Some(location) = &mut self.0 {
            text.hash(&mut location.fingerprint);
        }
        self
    }

    /// The same for results that also depend on what a file holds.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read.
    pub fn depending_on_file(mut self, path: &Path) -> Result<Self> {
        if let Some(location) = &mut self.0 {
            fs::read(path).map_err(|source| Error::Io { path: path.into(), source })?.hash(&mut location.fingerprint);
        }
        Ok(self)
    }

    /// The result of an earlier run, if neither its files nor anything that it depends on has changed.
    pub fn load<R: Saveable>(&self) -> Option<R> {
        let location = self.0.as_ref().filter(|location| !location.fresh)?;
        let result: Value = serde_json::from_str(&fs::read_to_string(location.folder.join(NAME)).ok()?).ok()?;
        let is_whole = |(name, hash): (&String, &Value)| location.hash(name).is_ok_and(|found| *hash == found);
        let holds =
            result["fingerprint"] == text(&location.fingerprint) && result["files"].as_object()?.iter().all(is_whole);
        if holds { R::from_json(&result) } else { None }
    }

    /// Keeps a result, with the files that `add` makes beside it.
    ///
    /// # Errors
    /// [`Error::Io`] with the file; those of `add`.
    pub fn save(&self, result: &impl Saveable, add: impl FnOnce(&mut Output) -> Result<()>) -> Result<()> {
        let Some(location) = &self.0 else { return Ok(()) };
        let mut output = Output::open(&location.folder)?;
        add(&mut output)?;
        // Until the last file appears, an earlier result does not fit these, and will not be found.
        output.finish()?;
        let mut result = result.to_json();
        result["fingerprint"] = text(&location.fingerprint).into();
        let files = output.names().iter().map(|&name| Ok((name.to_string(), location.hash(name)?.into())));
        result["files"] = Value::Object(files.collect::<Result<_>>()?);
        output.add_json(NAME, &result)?;
        output.finish()
    }
}

impl Location {
    /// What tells whether a file in the folder is still the same.
    fn hash(&self, name: &str) -> Result<String> {
        let path = self.folder.join(name);
        let mut hasher = DefaultHasher::new();
        fs::read(&path).map_err(|source| Error::Io { path, source })?.hash(&mut hasher);
        Ok(text(&hasher))
    }
}

fn text(hasher: &DefaultHasher) -> String {
    format!("{:016x}", hasher.finish())
}

/// The end of a sentence on where results are: how many of them an earlier run made.
pub fn reuse_note(reused: usize, total: usize) -> String {
    match reused {
        0 => String::new(),
        _ => format!("; {reused} of {total} results were there from an earlier run (--fresh computes them again)"),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use serde_json::json;

    use super::*;

    #[derive(Debug, PartialEq)]
    struct Number(u64);

    impl Saveable for Number {
        fn to_json(&self) -> Value {
            json!({ "number": self.0 })
        }

        fn from_json(value: &Value) -> Option<Self> {
            value["number"].as_u64().map(Self)
        }
    }

    #[test]
    fn a_result_is_found_while_all_that_it_depends_on_is_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("input");
        fs::write(&input, "picture").unwrap();
        let root = SavedResults::new(Some(folder.path()), false);
        let saved = || root.clone().below("a").depending_on("noise=3").depending_on_file(&input).unwrap();
        assert_eq!(saved().load::<Number>(), None);
        saved().save(&Number(7), |output| output.add("map", |out| out.write_all(b"1"))).unwrap();
        assert_eq!(saved().load(), Some(Number(7)));

        assert_eq!(root.clone().below("b").depending_on("noise=3").depending_on_file(&input).unwrap().load::<Number>(), None);
        assert_eq!(root.clone().below("a").depending_on("noise=4").depending_on_file(&input).unwrap().load::<Number>(), None);
        let fresh = SavedResults::new(Some(folder.path()), true).below("a").depending_on("noise=3");
        assert_eq!(fresh.depending_on_file(&input).unwrap().load::<Number>(), None);
        fs::write(&input, "another").unwrap();
        assert_eq!(saved().load::<Number>(), None);
        fs::write(&input, "picture").unwrap();
        assert_eq!(saved().load(), Some(Number(7)));
        let map = folder.path().join("a/map");
        fs::write(&map, "2").unwrap();
        assert_eq!(saved().load::<Number>(), None, "half of it is another");
        fs::write(&map, "1").unwrap();
        assert_eq!(saved().load(), Some(Number(7)));
        fs::remove_file(map).unwrap();
        assert_eq!(saved().load::<Number>(), None, "half of it is gone");
    }

    #[test]
    fn without_a_folder_nothing_is_kept_or_read() {
        let saved = SavedResults::new(None, false).below("a").depending_on_file(Path::new("nowhere")).unwrap();
        saved.save(&Number(7), |_| panic!("there is no folder")).unwrap();
        assert_eq!(saved.load::<Number>(), None);
        assert!(SavedResults::new(Some(Path::new("here")), false).depending_on_file(Path::new("nowhere")).is_err());
    }
}
