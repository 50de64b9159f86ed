//! Results saved in the output folder, so that an interrupted evaluation can be resumed.

use std::{
    fs::{self, File},
    hash::{DefaultHasher, Hash, Hasher},
    io::{self, Read},
    path::{Path, PathBuf},
    time::SystemTime,
};

use hsad::{Error, Result};
use serde_json::Value;

use crate::cli::{names::RESULT, output::Output};

/// A result that can be saved as JSON.
pub trait Saveable: Sized {
    /// The result as a JSON object.
    fn to_json(&self) -> Value;

    /// Reads an object that [`Self::to_json`] wrote; `None` if a value is missing.
    fn from_json(value: &Value) -> Option<Self>;
}

/// Where results are saved, and a fingerprint of everything that they depend on; without a folder nothing is saved.
#[derive(Clone, Debug)]
pub struct SavedResults(Option<Location>);

#[derive(Clone, Debug)]
struct Location {
    folder: PathBuf,
    /// Hash of everything that the results depend on. The standard library's hash function may change with the
    /// compiler, but then the program changes, too.
    fingerprint: DefaultHasher,
    /// Whether results of an earlier run are ignored.
    fresh: bool,
    /// Files that the results depend on, which no result may replace.
    read: Vec<PathBuf>,
}

impl SavedResults {
    /// Saves results below `folder`, valid for this build of the program only: a developer must not be shown the
    /// results of another build. Without a folder nothing is saved; with `fresh` nothing is loaded.
    pub fn new(folder: Option<&Path>, fresh: bool) -> Self {
        Self(folder.map(|folder| {
            let mut fingerprint = DefaultHasher::new();
            env!("CARGO_PKG_VERSION").hash(&mut fingerprint);
            let program = std::env::current_exe();
            if program.and_then(|program| hash_content(&program, &mut fingerprint)).is_err() {
                // The program file was replaced since the start: saved results cannot be attributed to this build.
                hash_this_run(&mut fingerprint);
            }
            Location { folder: folder.into(), fingerprint, fresh, read: Vec::new() }
        }))
    }

    /// Saved results in the subfolder `name`, with the same dependencies.
    #[must_use]
    pub fn below(mut self, name: &str) -> Self {
        if let Some(location) = &mut self.0 {
            location.folder.push(name);
        }
        self
    }

    /// Adds a text to the dependencies.
    #[must_use]
    pub fn depending_on(mut self, text: &str) -> Self {
        if let Some(location) = &mut self.0 {
            text.hash(&mut location.fingerprint);
        }
        self
    }

    /// Adds the content of a file to the dependencies.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read.
    pub fn depending_on_file(mut self, path: &Path) -> Result<Self> {
        if let Some(location) = &mut self.0 {
            let hashed = hash_content(path, &mut location.fingerprint);
            hashed.map_err(|source| Error::Io { path: path.into(), source })?;
            location.read.push(path.into());
        }
        Ok(self)
    }

    /// Files that no result may replace, besides those that the results depend on.
    #[must_use]
    pub fn sparing(mut self, files: impl IntoIterator<Item = PathBuf>) -> Self {
        if let Some(location) = &mut self.0 {
            location.read.extend(files);
        }
        self
    }

    /// The result of an earlier run; `None` if its files or one of its dependencies have changed.
    pub fn load<R: Saveable>(&self) -> Option<R> {
        let location = self.0.as_ref().filter(|location| !location.fresh)?;
        let result: Value = serde_json::from_str(&fs::read_to_string(location.folder.join(RESULT)).ok()?).ok()?;
        let is_whole =
            |(name, hash): (&String, &Value)| hash_of(&location.folder.join(name)).is_ok_and(|found| *hash == found);
        let holds =
            result["fingerprint"] == text(&location.fingerprint) && result["files"].as_object()?.iter().all(is_whole);
        if holds { R::from_json(&result) } else { None }
    }

    /// Saves a result, with the files that `add` adds beside it, in the place of an earlier one.
    ///
    /// # Errors
    /// [`Error::Io`] with the file, also for one that hsad did not write and that would be replaced; the errors of `add`.
    pub fn save(&self, result: &impl Saveable, add: impl FnOnce(&mut Output) -> Result<()>) -> Result<()> {
        let Some(location) = &self.0 else { return Ok(()) };
        let mut output = Output::open_result(&location.folder)?.sparing(location.read.iter().map(PathBuf::as_path));
        add(&mut output)?;
        let mut result = result.to_json();
        result["fingerprint"] = text(&location.fingerprint).into();
        let files = output.contents().map(|(name, content)| Ok((name.into(), hash_of(content)?.into())));
        result["files"] = Value::Object(files.collect::<Result<_>>()?);
        output.add_json(RESULT, &result)?;
        output.finish()
    }
}

/// Hash of the content of a file.
fn hash_of(path: &Path) -> Result<String> {
    let mut hasher = DefaultHasher::new();
    hash_content(path, &mut hasher).map_err(|source| Error::Io { path: path.into(), source })?;
    Ok(text(&hasher))
}

/// Adds the content of a file, piece by piece. A pipe or device is left to what reads it: it may have no end, or be read but once.
fn hash_content(path: &Path, hasher: &mut DefaultHasher) -> io::Result<()> {
    if !fs::metadata(path)?.is_file() {
        hash_this_run(hasher);
        return Ok(());
    }
    let (mut file, mut piece) = (File::open(path)?, vec![0; 1 << 16]);
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(()),
            length => hasher.write(&piece[..length]),
        }
    }
}

/// Adds what no other run has, so that nothing is reused.
fn hash_this_run(hasher: &mut DefaultHasher) {
    (std::process::id(), SystemTime::now()).hash(hasher);
}

fn text(hasher: &DefaultHasher) -> String {
    format!("{:016x}", hasher.finish())
}

/// End of the sentence about the output folder: how many results were reused from an earlier run; empty for none.
pub fn reuse_note(reused: usize, total: usize) -> String {
    match reused {
        0 => String::new(),
        _ => format!("; {reused} of {total} results are from an earlier run (--fresh computes them again)"),
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
        saved().save(&Number(7), |output| output.add("disparity.pfm", |out| out.write_all(b"1"))).unwrap();
        assert_eq!(saved().load(), Some(Number(7)));

        assert_eq!(
            root.clone().below("b").depending_on("noise=3").depending_on_file(&input).unwrap().load::<Number>(),
            None
        );
        assert_eq!(
            root.clone().below("a").depending_on("noise=4").depending_on_file(&input).unwrap().load::<Number>(),
            None
        );
        let fresh = SavedResults::new(Some(folder.path()), true).below("a").depending_on("noise=3");
        assert_eq!(fresh.depending_on_file(&input).unwrap().load::<Number>(), None);
        fs::write(&input, "another").unwrap();
        assert_eq!(saved().load::<Number>(), None);
        fs::write(&input, "picture").unwrap();
        assert_eq!(saved().load(), Some(Number(7)));
        let map = folder.path().join("a/disparity.pfm");
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
