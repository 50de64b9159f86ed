//! Output files that are written whole or not at all.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Write},
    mem,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use crate::error::{Error, Result};

/// Writes a file to a temporary place and moves it to `path` only when it is complete. If anything fails, an older file
/// at `path` stays unchanged.
///
/// The new file takes over the permissions of the file it replaces; a read-only file is not replaced; a link is
/// followed; a path that is no regular file (`/dev/null`, a pipe) is written to directly.
///
/// # Errors
/// [`Error::Io`] with `path`, for any failure.
pub fn write_whole<T>(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> Result<T> {
    let (staged, written) = Staged::write(path, write)?;
    staged.put()?;
    Ok(written)
}

/// A written file that is not yet moved to its place, so that several files appear together or not at all. Dropping it
/// removes the file.
#[derive(Debug)]
pub struct Staged {
    path: PathBuf,
    file: Temporary,
}

impl Staged {
    /// Writes the content for `path` to a temporary file next to it; the rules are those of [`write_whole`].
    ///
    /// # Errors
    /// As [`write_whole`].
    pub fn write<T>(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> Result<(Self, T)> {
        let failed = |source| Error::Io { path: path.into(), source };
        let (file, written) = stage(path, write).map_err(failed)?;
        Ok((Self { path: path.into(), file }, written))
    }

    /// Moves the file to its place.
    ///
    /// # Errors
    /// As [`write_whole`].
    pub fn put(self) -> Result<()> {
        let Self { path, file } = self;
        match file {
            None => Ok(()),
            Some((temporary, target)) => match temporary.persist(target) {
                Ok(_) => Ok(()),
                Err(error) => Err(Error::Io { path, source: error.error }),
            },
        }
    }
}

/// The temporary file and its target path; `None` if the target was written to directly.
type Temporary = Option<(tempfile::NamedTempFile, PathBuf)>;

fn stage<T>(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> io::Result<(Temporary, T)> {
    let old = fs::metadata(path).ok();
    match &old {
        Some(old) if old.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Some(old) if !old.is_file() => {
            return Ok((None, fill(&OpenOptions::new().write(true).open(path)?, write)?));
        }
        Some(old) if old.permissions().readonly() => {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
        }
        _ => {}
    }
    let target = if old.is_some() { fs::canonicalize(path)? } else { path.into() };
    let temporary = temporary_in(&folder(&target))?;
    let written = fill(temporary.as_file(), write)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions())?;
    }
    Ok((Some((temporary, target)), written))
}

/// Paths of all temporary files ever made, including those that are removed or moved by now.
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
pub fn temporary_in(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    if !folder.is_dir() {
        let reason = format!("there is no folder '{}': create it first", folder.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, reason));
    }
    let mut builder = tempfile::Builder::new();
    // By default only the owner can read a temporary file; the umask still applies to these permissions.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // Only the kind of the error is kept: its text names the temporary file, which means nothing to the user.
    builder.prefix(".hsad-");
    let mut temporaries = TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner);
    let file = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
    temporaries.push(file.path().into());
    Ok(file)
}

fn fill<T>(file: &File, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> io::Result<T> {
    let mut writer = BufWriter::new(file);
    let written = write(&mut writer)?;
    writer.flush()?;
    Ok(written)
}

/// The parent folder of `path`.
fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.into(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn writes_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        assert_eq!(write_whole(&path, |out| out.write_all(b"one").map(|()| 7)).unwrap(), 7);
        write_whole(&path, |out| out.write_all(b"two")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["map"]);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        fs::write(&path, "old").unwrap();
        let error = write_whole(&path, |out| {
            out.write_all(b"half")?;
            Err::<(), _>(io::Error::other("no more"))
        });
        assert_eq!(error.unwrap_err().to_string(), format!("{}: no more", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["map"]);
    }

    #[test]
    fn staged_files_appear_when_they_are_put() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        fs::write(&path, "old").unwrap();
        let staged = |text: &'static str| Staged::write(&path, |out| out.write_all(text.as_bytes())).unwrap().0;
        drop(staged("dropped"));
        assert_eq!(names(folder.path()), ["map"]);
        let new = staged("new");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        new.put().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["map"]);
    }

    #[test]
    fn a_missing_folder_and_a_folder_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/map");
        let error = write_whole(&missing, |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("no/map: there is no folder") && error.contains("create it"), "{error}");
        let error = write_whole(folder.path(), |_| Ok(())).unwrap_err();
        assert!(matches!(error, Error::Io { source, .. } if source.kind() == io::ErrorKind::IsADirectory));
    }

    #[test]
    fn a_name_alone_is_in_the_current_folder() {
        assert_eq!(folder(Path::new("map.pfm")), Path::new("."));
        assert_eq!(folder(Path::new("out/map.pfm")), Path::new("out"));
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let (usual, ours) = (folder.path().join("usual"), folder.path().join("ours"));
        fs::write(&usual, "").unwrap();
        write_whole(&ours, |_| Ok(())).unwrap();
        assert_eq!(mode(&ours), mode(&usual));

        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        write_whole(&ours, |_| Ok(())).unwrap();
        assert_eq!(mode(&ours), 0o640);

        fs::set_permissions(&ours, fs::Permissions::from_mode(0o444)).unwrap();
        assert!(write_whole(&ours, |_| Ok(())).unwrap_err().to_string().contains("read-only"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, |out| out.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_stays() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write_whole(&pipe, |out| out.write_all(b"through")).unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
}
