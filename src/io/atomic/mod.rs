//! Output files that are written whole or not at all.

mod set;
mod temporary;

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    thread,
};

pub use set::replace_all;
#[cfg(unix)]
pub use temporary::lock::try_take as try_lock;
pub use temporary::{abandon, clear_leftovers, temporary_in, try_abandon};

use crate::error::{Error, Result};

/// Writes a file to a temporary place and moves it to `path` only when it is complete. If anything fails, an older file
/// at `path` stays unchanged.
///
/// The new file is synced before it takes its place, so that a system that loses power keeps one of both, and what fails late, as on a
/// network's disk that is full, is an error. It takes over the permissions of the file it replaces, but no set-user-ID, set-group-ID or
/// sticky bit; a read-only file is not replaced; a link is followed; a path that is no regular file (`/dev/null`, a pipe) is written to
/// directly. What killed processes left in the folder is removed.
///
/// # Errors
/// [`Error::Io`] with `path`, for any failure.
pub fn write_whole<T>(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> Result<T> {
    let (staged, written) = Staged::write(path, write)?;
    if let Some(target) = staged.target() {
        clear_leftovers(&folder(target));
    }
    staged.put()?;
    Ok(written)
}

/// Writes a new file as [`write_whole`] does, unless there is one at `path`, which stays as it is; whether the file was written.
///
/// Of several processes that do so at once one writes the file, where the file system has hard links or renames that replace nothing.
///
/// # Errors
/// As [`write_whole`].
pub fn write_new(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> Result<bool> {
    if path.exists() {
        return Ok(false);
    }
    let (mut staged, ()) = Staged::write(path, write)?;
    staged.sync()?;
    let Some((temporary, target)) = staged.file else { return Ok(true) };
    let put = temporary.persist_noclobber(&target).or_else(|error| match error.error.kind() {
        io::ErrorKind::AlreadyExists => Err(error),
        _ => error.file.persist(&target),
    });
    match put {
        Ok(_) => Ok(true),
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        Err(error) => Err(Error::Io { path: path.into(), source: error.error }),
    }
}

/// A written file that is not yet moved to its place, so that several files appear together or not at all. Dropping it
/// removes the file.
#[derive(Debug)]
pub struct Staged {
    path: PathBuf,
    file: Temporary,
    /// Whether the content is on the disk, and not only in the system's memory.
    is_synced: bool,
}

impl Staged {
    /// Writes the content for `path` to a temporary file next to it; the rules are those of [`write_whole`].
    ///
    /// # Errors
    /// As [`write_whole`].
    pub fn write<T>(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<T>) -> Result<(Self, T)> {
        let mut written = None;
        let staged = stage(path, Box::new(|out| write(out).map(|result| written = Some(result))));
        let file = staged.map_err(|source| Error::Io { path: path.into(), source })?;
        let written = written.expect("the result of a content without an error");
        Ok((Self { path: path.into(), file, is_synced: false }, written))
    }

    fn sync(&mut self) -> Result<()> {
        if let Some((temporary, _)) = self.file.as_ref().filter(|_| !self.is_synced) {
            temporary.as_file().sync_all().map_err(|source| Error::Io { path: self.path.clone(), source })?;
            self.is_synced = true;
        }
        Ok(())
    }

    /// The place that the file will take; `None` if it was written to directly.
    fn target(&self) -> Option<&Path> {
        self.file.as_ref().map(|(_, target)| &**target)
    }

    /// The path of the content before [`Self::put`].
    pub fn content(&self) -> &Path {
        self.file.as_ref().map_or(&self.path, |(temporary, _)| temporary.path())
    }

    /// Moves the file to its place, once it is on the disk.
    ///
    /// # Errors
    /// As [`write_whole`].
    pub fn put(mut self) -> Result<()> {
        self.sync()?;
        let Self { path, file, .. } = self;
        match file {
            None => Ok(()),
            Some((temporary, target)) => match temporary.persist(target) {
                Ok(_) => Ok(()),
                Err(error) => Err(Error::Io { path, source: error.error }),
            },
        }
    }
}

/// Brings the files to the disk at once, each in a thread of its own, as far as the system allows threads: most of the time is a disk's wait.
/// [`Staged::put`] does it for the others.
///
/// # Errors
/// [`Error::Io`] with the path of a file that cannot be written to the disk.
pub fn sync_all(staged: &mut [Staged]) -> Result<()> {
    thread::scope(|scope| {
        let spawn =
            |file| thread::Builder::new().name("sync".into()).spawn_scoped(scope, move || Staged::sync(file)).ok();
        let threads: Vec<_> = staged.iter_mut().filter_map(spawn).collect();
        threads.into_iter().try_for_each(|thread| thread.join().expect("a sync does not panic"))
    })
}

/// The temporary file and its target path; `None` if the target was written to directly.
type Temporary = Option<(tempfile::NamedTempFile, PathBuf)>;

/// What writes the content of a file.
type Content<'a> = Box<dyn FnOnce(&mut BufWriter<&File>) -> io::Result<()> + 'a>;

fn stage(path: &Path, write: Content<'_>) -> io::Result<Temporary> {
    let old = fs::metadata(path).ok();
    match &old {
        Some(old) if old.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Some(old) if !old.is_file() => {
            fill(&OpenOptions::new().write(true).open(path)?, write)?;
            return Ok(None);
        }
        Some(old) if old.permissions().readonly() => {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is read-only"));
        }
        _ => {}
    }
    let target = if old.is_some() { fs::canonicalize(path)? } else { path.into() };
    let temporary = temporary_in(&folder(&target))?;
    fill(temporary.as_file(), write)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(permissions_of(&old))?;
    }
    Ok(Some((temporary, target)))
}

/// The permissions of a file that replaces one with this metadata.
fn permissions_of(old: &fs::Metadata) -> fs::Permissions {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        fs::Permissions::from_mode(old.permissions().mode() & 0o777)
    }
    #[cfg(not(unix))]
    old.permissions()
}

fn fill(file: &File, write: Content<'_>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    write(&mut writer)?;
    writer.flush()
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
        #[cfg(unix)]
        fs::write(folder.path().join(".hsad-kiLLed"), "half").unwrap();
        write_whole(&path, |out| out.write_all(b"two")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["map"]);
    }

    #[test]
    fn a_new_file_takes_no_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map");
        // The second one is there before the first is put to its place.
        let second = || write_new(&path, |out| out.write_all(b"second"));
        let first = write_new(&path, |out| {
            assert!(second().unwrap());
            out.write_all(b"first")
        });
        assert!(!first.unwrap() && !second().unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"second");
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
        let mut new = [staged("new")];
        sync_all(&mut new).unwrap();
        assert!(new[0].is_synced);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        new.into_iter().for_each(|new| new.put().unwrap());
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

        fs::set_permissions(&ours, fs::Permissions::from_mode(0o6751)).unwrap();
        write_whole(&ours, |_| Ok(())).unwrap();
        assert_eq!(fs::metadata(&ours).unwrap().permissions().mode() & 0o7777, 0o751);

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
        let reader = thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write_whole(&pipe, |out| out.write_all(b"through")).unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    }
}
