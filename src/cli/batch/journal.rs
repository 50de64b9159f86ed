//! The journal of a batch: a line of JSON per pair that was worked on, written when its results are in their place.

use std::{
    collections::HashMap,
    fs::{self, File, OpenOptions},
    io::{self, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use super::record::Record;

/// The file that tells later runs how the pairs of a folder are matched.
const BATCH: &str = "batch.json";

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
    pub fn finished(&self, name: &str) -> Option<&Record> {
        self.0.get(name).filter(|record| !record.has_failed())
    }
}

impl Journal {
    /// Opens the journal `name` in `folder`, with what an earlier run has recorded there. `recipe` describes how pairs are matched.
    ///
    /// # Errors
    /// A folder of another batch, a journal that is there without `resume`, and the errors of files.
    pub fn open(folder: &Path, name: &str, recipe: &str, resume: bool) -> Result<(Self, Earlier)> {
        check_recipe(folder, recipe)?;
        let path = folder.join(name);
        let mut earlier = Earlier::default();
        if path.exists() {
            if !resume {
                bail!(
                    "{}: an earlier run has recorded pairs there: go on with it (--resume), or name another folder (-o)",
                    hsad::shown(&path)
                );
            }
            earlier = read(&path).with_context(|| hsad::shown(&path).to_string())?;
        }
        let file =
            OpenOptions::new().create(true).append(true).open(&path).with_context(|| hsad::shown(&path).to_string())?;
        Ok((Self { path, file }, earlier))
    }

    /// Appends the record of a pair; it is on the disk when this returns.
    ///
    /// # Errors
    /// [`hsad::Error::Io`] with the journal's path.
    pub fn add(&mut self, record: &Record) -> hsad::Result<()> {
        let line = format!("{}\n", record.to_json());
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|source| hsad::Error::Io { path: self.path.clone(), source })
    }
}

/// Notes how pairs are matched in a new folder, and compares it in a known one.
fn check_recipe(folder: &Path, recipe: &str) -> Result<()> {
    let path = folder.join(BATCH);
    let here = json!({ "version": env!("CARGO_PKG_VERSION"), "options": recipe });
    let known = match fs::read(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Ok(hsad::io::atomic::write_whole(&path, |out| writeln!(out, "{here:#}"))?);
        }
        read => read.with_context(|| hsad::shown(&path).to_string())?,
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
    let text = fs::read(path)?;
    let whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    if whole < text.len() {
        OpenOptions::new().write(true).open(path)?.set_len(whole as u64)?;
    }
    let mut records = HashMap::new();
    for (number, line) in (1..).zip(text[..whole].split(|&byte| byte == b'\n').filter(|line| !line.is_empty())) {
        let value = serde_json::from_slice(line).with_context(|| format!("line {number}"))?;
        let Some(record) = Record::from_json(value) else { bail!("line {number}: no record of hsad batch") };
        records.insert(record.name().to_owned(), record);
    }
    Ok(Earlier(records))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(name: &str, status: &str) -> Record {
        Record::from_json(json!({ "name": name, "status": status })).expect("a record")
    }

    #[test]
    fn a_journal_goes_on_after_a_line_that_was_not_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = |recipe: &str, resume| Journal::open(folder.path(), "report.jsonl", recipe, resume);
        let (mut journal, earlier) = open("quickly", false).expect("a new journal");
        assert!(earlier.finished("a").is_none());
        journal.add(&record("a", "done")).expect("a file");
        journal.add(&record("b", "failed")).expect("a file");
        journal.file.write_all(b"{\"name\": \"c\", \"sta").expect("a file");
        drop(journal);

        assert!(open("quickly", false).is_err(), "an earlier run's");
        assert!(open("slowly", true).is_err(), "other options");
        let (mut journal, earlier) = open("quickly", true).expect("the same batch");
        let finished = ["a", "b", "c"].map(|name| earlier.finished(name).is_some());
        assert_eq!(finished, [true, false, false]);
        journal.add(&record("c", "done")).expect("a file");
        drop(journal);
        let text = fs::read_to_string(folder.path().join("report.jsonl")).expect("a file");
        assert_eq!(text.lines().count(), 3, "{text}");
        let (_, earlier) = open("quickly", true).expect("the same batch");
        assert!(earlier.finished("c").is_some());
    }
}
