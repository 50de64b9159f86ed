//! The output folder of a run: all of its files appear, or none.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};

use hsad::{
    Error, Result,
    io::atomic::{self, Staged, temporary_in},
};
use serde_json::Value;

/// Folders that were created for a run, the deepest first. An interruption waits while the lock is held.
static CREATED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn created() -> MutexGuard<'static, Vec<PathBuf>> {
    CREATED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The exit code that a shell reports for a program ended by SIGINT.
const INTERRUPTED: i32 = 130;

/// Installs the handler that removes temporary files and empty folders when the process is interrupted by Ctrl-C,
/// SIGTERM or SIGHUP. The handler runs in a thread of its own, and the process ends without dropping anything. Where no
/// thread can be spawned, the handler runs in the thread that is interrupted.
///
/// # Errors
/// If the system refuses the handler.
pub fn clean_up_when_interrupted() -> anyhow::Result<()> {
    #[cfg(unix)]
    // SAFETY: no handler is installed. A write beyond a limit of file sizes is an error, as others are, and ends no process.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
    let ignored = ignored_signals();
    let handled = ctrlc::set_handler(|| {
        let created = created();
        atomic::abandon();
        remove_empty(&created);
        exit_at_once(INTERRUPTED);
    });
    match handled {
        Err(ctrlc::Error::System(_)) => without_thread(),
        handled => handled?,
    }
    keep_ignoring(&ignored);
    Ok(())
}

/// Ends the process and removes what [`clean_up_when_interrupted`] does, without waiting for any thread and without taking
/// memory. A list that is in use stays as it is.
pub fn abandon_at_once(code: i32) -> ! {
    atomic::try_abandon();
    if let Ok(created) = CREATED.try_lock() {
        remove_empty(&created);
    }
    exit_at_once(code)
}

/// Exits without the destructors of drivers: on an interrupt other threads still use what they would destroy, and at the end
/// of the program Mesa's now and then run code that is unloaded already, which ends in a segmentation fault.
pub fn exit_at_once(code: i32) -> ! {
    #[cfg(unix)]
    // SAFETY: `_exit` only ends the process.
    unsafe {
        libc::_exit(code)
    }
    #[cfg(not(unix))]
    std::process::exit(code)
}

/// The signals that interrupt.
#[cfg(unix)]
const SIGNALS: [libc::c_int; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

/// Handles interruptions in the thread that they interrupt.
#[cfg(unix)]
fn without_thread() {
    extern "C" fn handle(_: libc::c_int) {
        abandon_at_once(INTERRUPTED)
    }
    for signal in SIGNALS {
        // SAFETY: the handler takes no memory and no lock that is held, and does not return.
        unsafe {
            libc::signal(signal, handle as extern "C" fn(libc::c_int) as libc::sighandler_t);
        }
    }
}

#[cfg(not(unix))]
fn without_thread() {}

/// The signals that the parent process asked to ignore: nohup does, and a shell does for a background job.
#[cfg(unix)]
fn ignored_signals() -> Vec<libc::c_int> {
    let is_ignored = |&signal: &libc::c_int| {
        // SAFETY: without a new action the call only queries, and a zeroed action is valid to be overwritten.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            libc::sigaction(signal, std::ptr::null(), &mut action) == 0 && action.sa_sigaction == libc::SIG_IGN
        }
    };
    SIGNALS.into_iter().filter(is_ignored).collect()
}

#[cfg(unix)]
fn keep_ignoring(signals: &[libc::c_int]) {
    for &signal in signals {
        // SAFETY: ignoring a signal runs no code.
        unsafe {
            libc::signal(signal, libc::SIG_IGN);
        }
    }
}

#[cfg(not(unix))]
fn ignored_signals() {}

#[cfg(not(unix))]
fn keep_ignoring(_: &()) {}

/// Removes the folders that are empty; the system refuses to remove the others, so results are safe.
fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        let _ = fs::remove_dir(folder);
    }
}

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
        self::created().extend(created.iter().cloned());
        // From here on a failure removes the created folders: `output` is dropped.
        let output = Self { folder: folder.into(), created, staged: Vec::new(), names: Vec::new(), spared: Vec::new() };
        fs::create_dir_all(folder).map_err(|error| failed("the folder cannot be created", error))?;
        temporary_in(folder).map_err(|error| failed("no file can be written in this folder", error))?;
        Ok(output)
    }

    /// Spares the files that are read: no output replaces them.
    #[must_use]
    pub fn sparing<'p>(mut self, inputs: impl IntoIterator<Item = &'p Path>) -> Self {
        // What does not exist is told when it is read.
        self.spared.extend(inputs.into_iter().filter_map(|input| input.canonicalize().ok()));
        self
    }

    /// Writes a file that appears only with [`Self::finish`].
    ///
    /// # Errors
    /// [`Error::Io`] with its path; also if it would replace a file that is spared.
    pub fn add<T>(
        &mut self,
        name: &'static str,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>,
    ) -> Result<T> {
        let path = self.folder.join(name);
        if path.canonicalize().is_ok_and(|path| self.spared.contains(&path)) {
            let reason = "a result of this name would replace a file that was read: name another folder (-o)";
            return Err(Error::Io { path, source: io::Error::new(io::ErrorKind::AlreadyExists, reason) });
        }
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

    /// Moves all files to their places. An interruption waits until all have been moved.
    ///
    /// # Errors
    /// [`Error::Io`] with the path of the first file that cannot be moved.
    pub fn finish(&mut self) -> Result<()> {
        let _uninterrupted = created();
        self.staged.drain(..).try_for_each(Staged::put)
    }
}

/// Checks, before any work, whether a file can be written.
///
/// # Errors
/// [`Error::Io`] with its path.
pub fn check_writable(path: &Path) -> Result<()> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
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
