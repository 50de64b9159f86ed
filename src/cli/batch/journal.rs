//! The journal of a batch: a line of JSON per pair that was worked on, written when its results are in their place.

use std::{
    collections::HashMap,
    fs::{File, OpenOptions},
    io::{self, BufRead, BufReader, Read, Write},
    path::{Path, PathBuf},
};

use anyhow::{Result, anyhow, bail};
use hsad::{
    Error,
    io::{
        atomic::{clear_leftovers, try_lock, write_new},
        read_whole,
    },
    shown,
};
use serde_json::{Value, json};

use super::{
    frame::Frame,
    pair::Pair,
    record::{Finished, Record},
    results::Results,
};

/// The file that tells later runs how the pairs of a folder are matched.
const BATCH: &str = "batch.json";

/// Longest line of a journal, and longest description of options, that are read, in bytes.
const LONGEST_LINE: u64 = 1 << 24;
const MOST_OPTIONS: u64 = 1 << 20;

/// The journal of this run, or of this shard.
pub struct Journal {
    path: PathBuf,
    file: File,
}

/// The pairs whose results an earlier run has written, by their names.
#[derive(Default)]
pub struct Earlier(HashMap<Box<str>, Finished>);

impl Earlier {
    /// What was recorded of a pair that is finished, if its results are still there: what was removed since is made again.
    ///
    /// # Errors
    /// As [`Results::of`].
    pub fn finished(&self, pair: &Pair, frame: Option<&Frame>, results: &Results<'_>) -> Result<Option<&Finished>> {
        let Some((report, inputs)) = results.of(pair, frame)? else { return Ok(None) };
        let finished = self.0.get(&*pair.name).filter(|found| !found.has_failed_since);
        Ok(finished.filter(|found| results.are_of_batch(&report) && found.inputs == inputs))
    }

    /// Whether results of the pair, as it is now, have been written: what is left of them is none of the user's.
    pub fn has_written(&self, pair: &Pair, frame: Option<&Frame>) -> bool {
        self.0.get(&*pair.name).is_some_and(|found| found.inputs.other_input(pair, frame).is_none())
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
        let told = |what: &str| anyhow!("{}: {what}", shown(&path));
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
        let earlier = read(&path).map_err(|error| told(&format!("{error:#}")))?;
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
    if write_new(&path, |out| writeln!(out, "{here:#}"))? {
        return Ok(());
    }
    // That of an earlier run, or of one that began at the same time.
    let known = read_whole(&path, MOST_OPTIONS)?;
    if serde_json::from_slice::<Value>(&known).ok().as_ref() != Some(&here) {
        bail!(
            "{}: the pairs of this folder are matched with other options or by another version of hsad: name another folder (-o)",
            shown(&path)
        );
    }
    Ok(())
}

/// Reads the records of a journal line by line, and cuts off a line that was not written whole.
fn read(path: &Path) -> Result<Earlier> {
    let mut file = BufReader::new(File::open(path)?);
    let (mut finished, mut line, mut whole) = (HashMap::<Box<str>, Finished>::new(), Vec::new(), 0);
    for number in 1.. {
        line.clear();
        let length = file.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line)? as u64;
        let foreign = |what: &str| {
            anyhow!(
                "line {number}: {what}; remove the line, or the journal: pairs whose files are there are not matched again"
            )
        };
        let Some(text) = line.strip_suffix(b"\n") else {
            if length == LONGEST_LINE {
                return Err(foreign("no record of hsad batch"));
            }
            break;
        };
        whole += length;
        if text.is_empty() {
            continue;
        }
        let value = serde_json::from_slice(text).map_err(|error| foreign(&error.to_string()))?;
        let record = Record::from_json(value).ok_or_else(|| foreign("no record of hsad batch"))?;
        let found = record.finished().map_err(|name| {
            let name = shown(Path::new(name));
            anyhow!("line {number}: '{name}' was recorded without its inputs, by an earlier version of hsad: name another folder (-o)")
        })?;
        match found {
            Some(found) => _ = finished.insert(record.name().into(), found),
            None => {
                if let Some(found) = finished.get_mut(record.name()) {
                    found.has_failed_since = true;
                }
            }
        }
    }
    if whole < path.metadata()?.len() {
        OpenOptions::new().write(true).open(path)?.set_len(whole)?;
    }
    finished.shrink_to_fit();
    Ok(Earlier(finished))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn record(name: &str, status: &str) -> Record {
        let inputs = json!({ "left": { "path": "/left.png", "bytes": 1, "modified_ns": 2, "hash": "3" } });
        Record::from_json(json!({ "name": name, "status": status, "inputs": inputs })).expect("a record")
    }

    #[test]
    fn a_journal_goes_on_after_a_line_that_was_not_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = |recipe: &str, resume| Journal::open(folder.path(), "report.jsonl", recipe, resume);
        let is_finished =
            |earlier: &Earlier, name: &str| earlier.0.get(name).is_some_and(|found| !found.has_failed_since);
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
        journal.add(&record("c", "done")).expect("a file");
        journal.add(&record("a", "failed")).expect("a file");
        drop(journal);
        let text = fs::read_to_string(folder.path().join("report.jsonl")).expect("a file");
        assert_eq!(text.lines().count(), 4, "{text}");
        let (_, earlier) = open("quickly", true).expect("the same batch");
        assert_eq!(["a", "b", "c"].map(|name| is_finished(&earlier, name)), [false, false, true], "later lines count");
    }

    #[test]
    fn records_without_inputs_are_those_of_an_earlier_version() {
        let folder = tempfile::tempdir().expect("a folder");
        check_recipe(folder.path(), "quickly").expect("a new folder");
        let line = json!({ "name": "a", "status": "done", "left": "left.png" });
        fs::write(folder.path().join("report.jsonl"), format!("{line}\n")).expect("a file");
        let error = Journal::open(folder.path(), "report.jsonl", "quickly", true).map(|_| ()).expect_err("no inputs");
        assert!(error.to_string().contains("line 1: 'a' was recorded without its inputs"), "{error}");
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
