//! The journal of a batch: a line of JSON per pair that was worked on, written when its results are in their place.

use std::{
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, anyhow, bail};
use hsad::{
    Error,
    io::{
        atomic::{clear_leftovers, try_lock, write_whole},
        read_whole,
    },
};
use serde_json::{Value, json};

use super::{pair::Pair, record::Record};

/// The file that tells later runs how the pairs of a folder are matched.
const BATCH: &str = "batch.json";

/// Longest journal, and longest description of options, that are read, in bytes.
const MOST: u64 = 1 << 32;
const MOST_OPTIONS: u64 = 1 << 20;

/// The journal of this run, or of this shard.
pub struct Journal {
    path: PathBuf,
    file: File,
}

/// What an earlier run has recorded.
#[derive(Default)]
pub struct Earlier(HashMap<String, Record>);

impl Earlier {
    /// The record of a pair, unless its work failed: it is tried again.
    ///
    /// # Errors
    /// A record of other pictures by the same name.
    pub fn finished(&self, pair: &Pair) -> Result<Option<&Record>> {
        match self.0.get(&pair.name).filter(|record| !record.has_failed()) {
            Some(record) if !record.is_of(pair) => bail!(
                "the results '{}' of this folder are of other pictures than {}: name another folder (-o)",
                pair.name,
                hsad::shown(&pair.left)
            ),
            found => Ok(found),
        }
    }
}

impl Journal {
    /// Opens the journal `name` in `folder`, with what an earlier run has recorded there; no other run has it open. `recipe` describes how
    /// pairs are matched.
    ///
    /// # Errors
    /// A folder of another batch, a journal that is there without `resume` or that another run writes, and the errors of files.
    pub fn open(folder: &Path, name: &str, recipe: &str, resume: bool) -> Result<(Self, Earlier)> {
        let path = folder.join(name);
        let told = |what: &str| anyhow!("{}: {what}", hsad::shown(&path));
        let is_known = path.exists();
        if is_known && !path.is_file() {
            return Err(told("it is no file"));
        }
        // Which is older than every journal of the folder.
        if is_known && !folder.join(BATCH).exists() {
            return Err(told(&format!(
                "there is no {BATCH} beside it, and so it is none of hsad's: name another folder (-o)"
            )));
        }
        clear_leftovers(folder);
        check_recipe(folder, recipe)?;
        let file = OpenOptions::new().create(true).append(true).open(&path);
        let file = file.map_err(|source| Error::Io { path: path.clone(), source })?;
        if try_lock(&file).is_err_and(|error| error.kind() == io::ErrorKind::WouldBlock) {
            return Err(told("another run of hsad is at work there: name another folder (-o), or wait for its end"));
        }
        if is_known && !resume {
            return Err(told(
                "an earlier run has recorded pairs there: go on with it (--resume), or name another folder (-o)",
            ));
        }
        let earlier = read(&path).map_err(|error| {
            told(&format!(
                "{error:#}; remove the line, or the journal: pairs whose files are there are not matched again"
            ))
        })?;
        Ok((Self { path, file }, earlier))
    }

    /// Appends the record of a pair; it is on the disk when this returns.
    ///
    /// # Errors
    /// [`hsad::Error::Io`] with the journal's path.
    pub fn add(&mut self, record: &Record) -> hsad::Result<()> {
        let line = format!("{}\n", record.to_json());
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|source| Error::Io { path: self.path.clone(), source })
    }
}

/// Notes how pairs are matched in a new folder, and compares it in a known one.
fn check_recipe(folder: &Path, recipe: &str) -> Result<()> {
    let path = folder.join(BATCH);
    let here = json!({ "version": env!("CARGO_PKG_VERSION"), "options": recipe });
    let known = match read_whole(&path, MOST_OPTIONS) {
        Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
            return Ok(write_whole(&path, |out| writeln!(out, "{here:#}"))?);
        }
        read => read?,
    };
    if serde_json::from_slice::<Value>(&known).ok().as_ref() != Some(&here) {
        bail!(
            "{}: the pairs of this folder are matched with other options or by another version of hsad: name another folder (-o)",
            hsad::shown(&path)
        );
    }
    Ok(())
}

/// Reads the records of a journal, and cuts off a line that was not written whole.
fn read(path: &Path) -> Result<Earlier> {
    if path.metadata()?.len() == 0 {
        return Ok(Earlier::default());
    }
    let text = read_whole(path, MOST)?;
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let mut records = HashMap::new();
    for (number, line) in (1..).zip(text[..whole].split(|&byte| byte == b'\n').filter(|line| !line.is_empty())) {
        let value = serde_json::from_slice(line).with_context(|| format!("line {number}"))?;
        let Some(record) = Record::from_json(value) else { bail!("line {number}: no record of hsad batch") };
        records.insert(record.name().to_owned(), record);
    }
    if whole < text.len() {
        OpenOptions::new().write(true).open(path)?.set_len(whole as u64)?;
    }
    Ok(Earlier(records))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn pair(name: &str) -> Pair {
        Pair { name: name.into(), left: "left.png".into(), right: Some("right.png".into()), calibration: None }
    }

    fn record(name: &str, status: &str) -> Record {
        let value = json!({ "name": name, "status": status, "left": "left.png", "right": "right.png" });
        Record::from_json(value).expect("a record")
    }

    #[test]
    fn a_journal_goes_on_after_a_line_that_was_not_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = |recipe: &str, resume| Journal::open(folder.path(), "report.jsonl", recipe, resume);
        let is_finished =
            |earlier: &Earlier, name: &str| earlier.finished(&pair(name)).expect("the same pictures").is_some();
        let (mut journal, earlier) = open("quickly", false).expect("a new journal");
        assert!(!is_finished(&earlier, "a"));
        let second = open("quickly", true).map(|_| ()).expect_err("two at once").to_string();
        assert!(second.contains("another run"), "{second}");
        journal.add(&record("a", "done")).expect("a file");
        journal.add(&record("b", "failed")).expect("a file");
        journal.file.write_all(b"{\"name\": \"c\", \"sta").expect("a file");
        drop(journal);

        assert!(open("quickly", false).is_err(), "an earlier run's");
        assert!(open("slowly", true).is_err(), "other options");
        let (mut journal, earlier) = open("quickly", true).expect("the same batch");
        assert_eq!(["a", "b", "c"].map(|name| is_finished(&earlier, name)), [true, false, false]);
        let other = Pair { left: "other.png".into(), ..pair("a") };
        assert!(earlier.finished(&other).is_err(), "other pictures");
        journal.add(&record("c", "done")).expect("a file");
        drop(journal);
        let text = fs::read_to_string(folder.path().join("report.jsonl")).expect("a file");
        assert_eq!(text.lines().count(), 3, "{text}");
        let (_, earlier) = open("quickly", true).expect("the same batch");
        assert!(is_finished(&earlier, "c"));
    }
    #[test]
    fn what_is_no_journal_stays_as_it_is() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("report.jsonl");
        fs::write(&path, "{\"mine\": 1}\n{\"no end\"").expect("a file");
        let open = || Journal::open(folder.path(), "report.jsonl", "quickly", true).map(|_| ()).expect_err("foreign");
        assert!(open().to_string().contains("none of hsad's"));
        check_recipe(folder.path(), "quickly").expect("a new folder");
        assert!(open().to_string().contains("line 1"));
        assert_eq!(fs::read(&path).expect("a file"), b"{\"mine\": 1}\n{\"no end\"");
    }
}
