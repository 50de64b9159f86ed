//! The output folder of a run: all of its files appear, or none.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    mem,
    path::{Path, PathBuf},
};

use hsad::{
    Error, Result,
    io::atomic::{self, Staged, temporary_in},
};
use serde_json::Value;

use super::{
    earlier_set::{EarlierSet, FolderLock, UNFINISHED},
    interruption::{self, remove_empty},
    names::{REPORT, RESULT, is_ours},
    terminal,
};

/// Staged output files. Unless [`Self::finish`] is reached, no file appears, and the folders that were created for
/// the files are removed.
pub struct Output {
    folder: PathBuf,
    /// Folders that this run created, the deepest first.
    created: Vec<PathBuf>,
    staged: Vec<Staged>,
    names: Vec<&'static str>,
    /// Files that no output may replace, without links.
    spared: Vec<PathBuf>,
    /// What an earlier run left, if the files of the folder are a set.
    set: Option<Set>,
}

/// A folder of which one run at a time writes all files that are hsad's.
struct Set {
    /// Name of the file that lists the others.
    list: &'static str,
    earlier: EarlierSet,
    /// Whether files that no list names are an earlier run's, too.
    is_taken_over: bool,
    _lock: FolderLock,
}

impl Output {
    /// Creates `folder` if it is missing, and checks that files can be written there.
    ///
    /// # Errors
    /// [`Error::Io`] with `folder`.
    pub fn open(folder: &Path) -> Result<Self> {
        let failed = |what: &str, error: io::Error| {
            let reason = format!("{what} ({error}): name another folder");
            Error::Io { path: folder.into(), source: io::Error::new(error.kind(), reason) }
        };
        if folder.exists() && !folder.is_dir() {
            return Err(failed("the results need a folder", io::ErrorKind::NotADirectory.into()));
        }
        let missing = |path: &&Path| *path != Path::new("") && !path.exists();
        let created: Vec<_> = folder.ancestors().take_while(missing).map(Path::to_path_buf).collect();
        interruption::created(&created);
        // From here on a failure removes the created folders: `output` is dropped.
        let output = Self {
            folder: folder.into(),
            created,
            staged: Vec::new(),
            names: Vec::new(),
            spared: Vec::new(),
            set: None,
        };
        fs::create_dir_all(folder).map_err(|error| failed("the folder cannot be created", error))?;
        temporary_in(folder).map_err(|error| failed("no file can be written in this folder", error))?;
        atomic::clear_leftovers(folder);
        Ok(output)
    }

    /// As [`Self::open`], for files that are a set, with a report that lists them: [`Self::finish`] puts them in the place of the set of
    /// an earlier run, and files that hsad did not write are not replaced.
    ///
    /// # Errors
    /// As [`Self::open`], and if another run is about to write a set there.
    pub fn open_set(folder: &Path) -> Result<Self> {
        Self::open_listed(folder, REPORT)
    }

    /// As [`Self::open_set`], for a result of an evaluation and the files beside it.
    ///
    /// # Errors
    /// As [`Self::open_set`].
    pub fn open_result(folder: &Path) -> Result<Self> {
        Self::open_listed(folder, RESULT)
    }

    fn open_listed(folder: &Path, list: &'static str) -> Result<Self> {
        let mut output = Self::open(folder)?;
        let Some(lock) = FolderLock::take(folder) else {
            // The folder is that of the other run.
            output.created.clear();
            let reason =
                "another run of hsad is writing its results there: name another folder (-o), or wait for its end";
            return Err(Error::Io { path: folder.into(), source: io::Error::new(io::ErrorKind::ResourceBusy, reason) });
        };
        output.set = Some(Set { list, earlier: EarlierSet::read(folder, list), is_taken_over: false, _lock: lock });
        Ok(output)
    }

    /// Takes files of a set whose list is gone for those of an earlier run, which is known to have written one: they are replaced.
    pub fn take_over(&mut self) {
        if let Some(set) = &mut self.set {
            set.is_taken_over = !self.folder.join(set.list).exists();
        }
    }

    /// Spares the files that are read: no output replaces them.
    #[must_use]
    pub fn sparing<'p>(mut self, inputs: impl IntoIterator<Item = &'p Path>) -> Self {
        self.spare(inputs);
        self
    }

    /// As [`Self::sparing`].
    pub fn spare<'p>(&mut self, inputs: impl IntoIterator<Item = &'p Path>) {
        // What does not exist is told when it is read.
        self.spared.extend(inputs.into_iter().filter_map(|input| input.canonicalize().ok()));
    }

    /// Checks that a file of this name may be written: before the work, if it is known to be written after it.
    ///
    /// # Errors
    /// [`Error::Io`] with its path, if it would replace a file that is spared, or in a set one that hsad did not write.
    pub fn check(&self, name: &str) -> Result<()> {
        let path = self.folder.join(name);
        let refused = |reason: String| {
            Err(Error::Io { path: path.clone(), source: io::Error::new(io::ErrorKind::AlreadyExists, reason) })
        };
        if path.canonicalize().is_ok_and(|path| self.spared.contains(&path)) {
            return refused(
                "a result of this name would replace a file that was read: name another folder (-o)".into(),
            );
        }
        // No run of hsad makes links.
        let is_link = path.is_symlink();
        let is_foreign = |set: &Set| path.is_file() && (is_link || !set.earlier.contains(name) && !set.is_taken_over);
        if let Some(Set { list, .. }) = self.set.as_ref().filter(|set| is_foreign(set)) {
            return refused(format!(
                "a result of this name would replace a file that no {list} beside it lists as hsad's: name another folder (-o), or move the \
                 file"
            ));
        }
        Ok(())
    }

    /// Writes a file that appears only with [`Self::finish`].
    ///
    /// # Errors
    /// [`Error::Io`] with its path, and as [`Self::check`].
    pub fn add<T>(
        &mut self,
        name: &'static str,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>,
    ) -> Result<T> {
        debug_assert!(self.set.is_none() || is_ours(name), "{name} is in no list of names");
        self.check(name)?;
        let path = self.folder.join(name);
        let (staged, written) = Staged::write(&path, write)?;
        self.staged.push(staged);
        self.names.push(name);
        Ok(written)
    }

    /// Writes indented JSON to a file that appears only with [`Self::finish`].
    ///
    /// # Errors
    /// As [`Self::add`].
    pub fn add_json(&mut self, name: &'static str, value: &Value) -> Result<()> {
        self.add(name, |out| write_json(out, value))
    }

    /// The output folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Names of the files added so far.
    pub fn names(&self) -> &[&'static str] {
        &self.names
    }

    /// Names of the files that are not in their places yet, and paths of their contents.
    pub fn contents(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let staged = &self.names[self.names.len() - self.staged.len()..];
        staged.iter().copied().zip(self.staged.iter().map(Staged::content))
    }

    /// Moves all files to their places; those of an earlier set that are not among them go. An interruption waits until all is done.
    ///
    /// # Errors
    /// [`Error::Io`] with the path of the first file that cannot be moved; all files are as they were before, then.
    pub fn finish(&mut self) -> Result<()> {
        atomic::sync_all(&mut self.staged)?;
        interruption::uninterrupted(None, || self.replace())
    }

    /// As [`Self::finish`], for the last thing that a run does: an interruption from then on ends the program with `code`.
    ///
    /// # Errors
    /// As [`Self::finish`].
    pub fn finish_run(&mut self, code: i32) -> Result<()> {
        atomic::sync_all(&mut self.staged)?;
        interruption::uninterrupted(Some(code), || self.replace())
    }

    fn replace(&mut self) -> Result<()> {
        let is_spared = |path: &PathBuf| path.canonicalize().is_ok_and(|path| self.spared.contains(&path));
        let stale: Vec<PathBuf> = match &self.set {
            Some(set) => set.earlier.without(&self.folder, &self.names).filter(|path| !is_spared(path)).collect(),
            None => Vec::new(),
        };
        let staged = mem::take(&mut self.staged);
        let staged = match &self.set {
            Some(set) => self.listed_first(staged, set.list)?,
            None => staged,
        };
        atomic::replace_all(staged, &stale)
    }

    /// `staged`, the last of the files, in the order in which they take their places: first the one called `list`, so that later runs know the
    /// others where the process is killed then. Where any of these replaces one, that list says that the set is [`UNFINISHED`], and the one that
    /// does not comes last.
    fn listed_first(&self, mut staged: Vec<Staged>, list: &str) -> Result<Vec<Staged>> {
        let names = &self.names[self.names.len() - staged.len()..];
        let Some(place) = names.iter().position(|name| *name == list) else { return Ok(staged) };
        let replaces = names.iter().any(|name| *name != list && self.folder.join(name).exists());
        let last = staged.remove(place);
        if !replaces {
            staged.insert(0, last);
            return Ok(staged);
        }
        let path = self.folder.join(list);
        let failed = |source| Error::Io { path: path.clone(), source };
        let content = fs::read(last.content()).map_err(failed)?;
        let mut value: Value = serde_json::from_slice(&content).map_err(|error| failed(error.into()))?;
        value[UNFINISHED] = true.into();
        let (first, ()) = Staged::write(&path, |out| write_json(out, &value))?;
        staged.insert(0, first);
        staged.push(last);
        Ok(staged)
    }
}

/// Whether the path of a file stands for standard output: `-`.
pub fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Writes a text to a file, whole, or to standard output for `-`.
///
/// # Errors
/// [`Error::Io`] with the path.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    if is_stdout(path) {
        return terminal::print(text).map_err(|source| Error::Io { path: path.into(), source });
    }
    atomic::write_whole(path, |out| out.write_all(text.as_bytes()))
}

/// The folder that a file lies in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

/// Checks, before any work, whether a file can be written.
///
/// # Errors
/// [`Error::Io`] with its path.
pub fn check_writable(path: &Path) -> Result<()> {
    if is_stdout(path) {
        return Ok(());
    }
    let folder = folder_of(path);
    // An existing path may be a pipe or /dev/stdout, next to which no temporary file can be made.
    let tried = if path.is_dir() {
        Err(io::ErrorKind::IsADirectory.into())
    } else if path.exists() {
        Ok(())
    } else {
        temporary_in(folder).map(drop)
    };
    tried.map_err(|error| {
        let reason = format!("the file cannot be written ({error}): name another one");
        Error::Io { path: path.into(), source: io::Error::new(error.kind(), reason) }
    })
}

/// Checks, before any work, that tables can be written, each to a place of its own, and none to that of a file that is read.
///
/// # Errors
/// [`Error::Io`] with the path of a table.
pub fn check_tables<'p>(
    tables: impl IntoIterator<Item = &'p Path>,
    read: impl IntoIterator<Item = &'p Path>,
) -> Result<()> {
    // A file that is not there yet lies in a folder that is.
    let in_folder = |path: &Path| Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
    let place = |path: &Path| match path {
        _ if is_stdout(path) => path.into(),
        _ => path.canonicalize().ok().or_else(|| in_folder(path)).unwrap_or_else(|| path.into()),
    };
    let read: Vec<PathBuf> = read.into_iter().filter_map(|path| path.canonicalize().ok()).collect();
    let mut places: Vec<PathBuf> = Vec::new();
    for table in tables {
        let refused = |reason: &str| {
            Err(Error::Io { path: table.into(), source: io::Error::new(io::ErrorKind::AlreadyExists, reason) })
        };
        check_writable(table)?;
        if read.contains(&place(table)) {
            return refused("it would replace a file that is read: name another one");
        }
        if places.contains(&place(table)) {
            return refused("two tables cannot have one place: name another one for one of them");
        }
        places.push(place(table));
    }
    Ok(())
}

/// Writes indented JSON and a line feed.
///
/// # Errors
/// The errors of `out`.
pub fn write_json(out: &mut impl Write, value: &Value) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, value)?;
    out.write_all(b"\n")
}

impl Drop for Output {
    fn drop(&mut self) {
        self.staged.clear();
        remove_empty(&self.created);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_a_set_takes_its_place_first_and_is_unfinished_where_files_are_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let order = |expected: &[&str]| {
            let mut output = Output::open_set(folder.path()).unwrap();
            output.add("disparity.pfm", |out| out.write_all(b"map")).unwrap();
            output.add_json(REPORT, &serde_json::json!({ "version": "1", "files": ["disparity.pfm"] })).unwrap();
            let staged = mem::take(&mut output.staged);
            let staged = output.listed_first(staged, REPORT).unwrap();
            let what = |staged: &Staged| {
                let text = fs::read_to_string(staged.content()).unwrap();
                match (text.contains("version"), text.contains(UNFINISHED)) {
                    (false, _) => "map",
                    (true, false) => "list",
                    (true, true) => "unfinished list",
                }
            };
            assert_eq!(staged.iter().map(what).collect::<Vec<_>>(), expected);
            atomic::replace_all(staged, &[]).unwrap();
        };
        order(&["list", "map"]);
        order(&["unfinished list", "map", "list"]);
        assert!(!fs::read_to_string(folder.path().join(REPORT)).unwrap().contains(UNFINISHED));
    }

    #[cfg(unix)]
    #[test]
    fn a_set_replaces_no_link() {
        let folder = tempfile::tempdir().unwrap();
        let (mine, link) = (folder.path().join("mine"), folder.path().join("out/disparity.pfm"));
        fs::create_dir(folder.path().join("out")).unwrap();
        fs::write(&mine, "mine").unwrap();
        std::os::unix::fs::symlink(&mine, &link).unwrap();
        let report = serde_json::json!({ "version": "1", "files": ["disparity.pfm"] });
        fs::write(folder.path().join("out").join(REPORT), report.to_string()).unwrap();
        let mut output = Output::open_set(&folder.path().join("out")).unwrap();
        assert!(output.add("disparity.pfm", |out| out.write_all(b"map")).is_err());
    }

    #[test]
    fn folders_go_again_unless_files_appear() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("a/b");
        let mut output = Output::open(&folder).unwrap();
        output.add("one", |out| out.write_all(b"1")).unwrap();
        assert!(!folder.join("one").exists());
        drop(output);
        assert!(!parent.path().join("a").exists());

        let mut output = Output::open(&folder).unwrap();
        output.add("one", |out| out.write_all(b"1")).unwrap();
        output.add("two", |_| Ok(())).unwrap();
        output.finish().unwrap();
        assert_eq!(output.names(), ["one", "two"]);
        drop(output);
        assert_eq!(fs::read(folder.join("one")).unwrap(), b"1");
    }

    #[test]
    fn a_folder_that_was_there_stays() {
        let folder = tempfile::tempdir().unwrap();
        drop(Output::open(folder.path()).unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_is_no_folder_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "mine").unwrap();
        assert!(Output::open(&file).err().unwrap().to_string().contains("name another folder"));
        assert!(Output::open(&file.join("below")).is_err());
        assert_eq!(fs::read(&file).unwrap(), b"mine");
    }
}
