//! Temporary files: locked while their process lives, so that those of a process that was killed can be told.

use std::{
    fs::{self, File},
    io, mem,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use tempfile::NamedTempFile;

use crate::error::shown;

/// The beginning of the name of each temporary file.
const PREFIX: &str = ".hsad-";

/// Number of letters and digits behind [`PREFIX`].
const RANDOM: usize = 6;

/// Paths of the temporary files, and of some that are removed or moved by now.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes the temporary files that are not moved to their place yet, and keeps all threads from making another. For an
/// interrupted process that ends without dropping anything.
pub fn abandon() {
    let temporaries = TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner);
    remove(&temporaries);
    mem::forget(temporaries);
}

/// Does what [`abandon`] does, unless a file is being made: for a thread that cannot wait, since it may be the one that makes
/// it.
pub fn try_abandon() {
    if let Ok(temporaries) = TEMPORARIES.try_lock() {
        remove(&temporaries);
        mem::forget(temporaries);
    }
}

fn remove(temporaries: &[PathBuf]) {
    for path in temporaries {
        // Most of the files are removed or moved already.
        let _ = fs::remove_file(path);
    }
}

/// A temporary file in `folder`, removed when dropped. Also the way to check, before any work, whether files can be
/// written in `folder`.
///
/// # Errors
/// The errors of the system, and an error if `folder` does not exist.
pub fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    if !folder.is_dir() {
        let reason = format!("there is no folder '{}': create it first", shown(folder));
        return Err(io::Error::new(io::ErrorKind::NotFound, reason));
    }
    let mut builder = builder();
    // By default only the owner can read a temporary file; the umask still applies to these permissions.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporaries = TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        // Only the kind of the error is kept: its text names the temporary file, which means nothing to the user.
        let file = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
        if is_taken(file.as_file()) {
            continue;
        }
        if temporaries.len() == temporaries.capacity() {
            // Before the list grows: most of the files are removed or moved by now.
            temporaries.retain(|path| path.exists());
        }
        temporaries.push(file.path().into());
        return Ok(file);
    }
}

/// A second name in its folder for `file`, removed when dropped; where the file system has no second names, `file` is moved to it.
pub(super) fn aside(file: &Path) -> io::Result<tempfile::TempPath> {
    let made = |make: fn(&Path, &Path) -> io::Result<()>| {
        let made = builder().make_in(super::folder(file), |name| make(file, name));
        made.map(NamedTempFile::into_temp_path).map_err(|error| io::Error::from(error.kind()))
    };
    made(|file, name| fs::hard_link(file, name)).or_else(|_| {
        made(|file, name| if name.exists() { Err(io::ErrorKind::AlreadyExists.into()) } else { fs::rename(file, name) })
    })
}

/// Removes the temporary files in `folder` of processes that no longer live, as far as the system lets it.
pub fn clear_leftovers(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.filter_map(Result::ok) {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && entry.file_name().to_str().is_some_and(is_temporary) {
            let path = entry.path();
            if File::open(&path).is_ok_and(|file| lock::take(&file)) {
                let _ = fs::remove_file(path);
            }
        }
    }
}

fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    builder
}

fn is_temporary(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX);
    random.is_some_and(|random| random.len() == RANDOM && random.chars().all(|letter| letter.is_ascii_alphanumeric()))
}

/// Locks a new file; whether another process was earlier, has taken the file for one that was left, and removes it.
#[cfg(unix)]
fn is_taken(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    match lock::try_take(file) {
        Ok(()) => file.metadata().is_ok_and(|metadata| metadata.nlink() == 0),
        Err(error) => error.kind() == io::ErrorKind::WouldBlock,
    }
}

#[cfg(not(unix))]
fn is_taken(_: &File) -> bool {
    false
}

/// Locks of whole files and folders, which end with the process that holds them.
pub mod lock {
    use std::fs::File;

    /// Locks `file` until it is closed; false if another process holds it, or if the file system has no locks.
    #[cfg(unix)]
    pub fn take(file: &File) -> bool {
        try_take(file).is_ok()
    }

    /// No leftover is told from a file in use.
    #[cfg(not(unix))]
    pub fn take(_: &File) -> bool {
        false
    }

    /// Locks `file`, or an open folder, until it is closed.
    ///
    /// # Errors
    /// [`std::io::ErrorKind::WouldBlock`] if another process holds it; other kinds if the file system has no locks.
    #[cfg(unix)]
    pub fn try_take(file: &File) -> std::io::Result<()> {
        use std::os::fd::AsRawFd;
        // SAFETY: the descriptor is open for as long as `file` is borrowed.
        match unsafe { libc::flock(file.as_raw_fd(), libc::LOCK_EX | libc::LOCK_NB) } {
            0 => Ok(()),
            _ => Err(std::io::Error::last_os_error()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_temporary_files_by_hand() {
        assert!([".hsad-a1B2c3", ".hsad-ZZZZZZ"].iter().all(|name| is_temporary(name)));
        for other in ["hsad-a1B2c3", ".hsad-a1B2c", ".hsad-a1B2c3d", ".hsad-", ".hsad-cach.e", ".hsad-äöü"] {
            assert!(!is_temporary(other), "{other}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn files_of_the_dead_are_cleared_and_those_of_the_living_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let living = temporary_in(folder.path()).unwrap();
        for name in [".hsad-dead00", ".hsad-config", ".hsad-x", "mine"] {
            fs::write(path(name), name).unwrap();
        }
        fs::create_dir(path(".hsad-folder")).unwrap();
        clear_leftovers(folder.path());
        let there = |name: &str| path(name).exists();
        assert!(living.path().exists() && there(".hsad-x") && there("mine") && there(".hsad-folder"));
        assert!(!there(".hsad-dead00"));
        clear_leftovers(&path("nowhere"));
    }
}
