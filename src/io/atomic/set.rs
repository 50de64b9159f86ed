//! Files that take the place of earlier ones together.

use std::{
    collections::BTreeSet,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use tempfile::TempPath;

use super::{Staged, folder, temporary::aside};
use crate::error::{Error, Result};

/// Moves `staged` files to their places and removes `stale` ones. If anything fails, all files are as they were before.
///
/// Each earlier file keeps its name until the new one takes it.
///
/// # Errors
/// [`Error::Io`] with the path that cannot be replaced or removed.
pub fn replace_all(staged: Vec<Staged>, stale: &[PathBuf]) -> Result<()> {
    let targets: Vec<PathBuf> = staged.iter().filter_map(|staged| Some(staged.target()?.to_path_buf())).collect();
    let mut earlier = Earlier::default();
    for target in targets.iter().map(PathBuf::as_path).chain(stale.iter().map(PathBuf::as_path)) {
        earlier.keep(target)?;
    }
    // Where the process is killed in between, the earlier list still names what is there.
    for path in stale {
        match fs::remove_file(path) {
            Err(source) if path.exists() => return Err(Error::Io { path: path.into(), source }),
            _ => {}
        }
    }
    staged.into_iter().try_for_each(Staged::put)?;
    earlier.forget();
    let folders: BTreeSet<PathBuf> = targets.iter().chain(stale).map(|path| folder(path)).collect();
    folders.iter().for_each(|path| sync(path));
    Ok(())
}

/// The files as they were, which come back when this is dropped.
#[derive(Default)]
struct Earlier(Vec<(PathBuf, Option<TempPath>)>);

impl Earlier {
    fn keep(&mut self, path: &Path) -> Result<()> {
        let failed = |source| Error::Io { path: path.into(), source };
        let kept = match path.symlink_metadata() {
            Ok(found) if found.is_dir() => return Err(failed(io::ErrorKind::IsADirectory.into())),
            Ok(_) => Some(aside(path).map_err(failed)?),
            Err(_) => None,
        };
        self.0.push((path.into(), kept));
        Ok(())
    }

    fn forget(&mut self) {
        self.0.clear();
    }
}

impl Drop for Earlier {
    fn drop(&mut self) {
        for (path, kept) in self.0.drain(..) {
            // The failure that led here is told; what fails on top of it cannot be mended.
            let Some(kept) = kept else {
                let _ = fs::remove_file(&path);
                continue;
            };
            let name = kept.to_path_buf();
            // Where `path` was not replaced yet, both are names of one file, and the system renames nothing.
            if kept.persist(&path).is_ok() {
                let _ = fs::remove_file(name);
            }
        }
    }
}

/// Makes the names in a folder outlast a loss of power, where the system lets a folder be synced.
fn sync(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn staged(path: &Path, text: &'static str) -> Staged {
        Staged::write(path, |out| out.write_all(text.as_bytes())).unwrap().0
    }

    fn contents(folder: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
        let mut contents: Vec<_> = entries
            .map(|entry| {
                (entry.file_name().into_string().unwrap(), fs::read_to_string(entry.path()).unwrap_or_default())
            })
            .collect();
        contents.sort();
        contents
    }

    fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
        expected.iter().map(|&(name, text)| (name.into(), text.into())).collect()
    }

    #[test]
    fn a_set_takes_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a", "b", "c", "mine"] {
            fs::write(path(name), "old").unwrap();
        }
        let new = vec![staged(&path("a"), "new"), staged(&path("d"), "new")];
        replace_all(new, &[path("b"), path("c"), path("never")]).unwrap();
        assert_eq!(contents(folder.path()), pairs(&[("a", "new"), ("d", "new"), ("mine", "old")]));
    }

    #[test]
    fn a_failure_midway_leaves_the_old_set_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["a", "b", "c"] {
            fs::write(path(name), "old").unwrap();
        }
        let old = contents(folder.path());
        let new = vec![staged(&path("a"), "new"), staged(&path("first"), "new"), staged(&path("c"), "new")];
        fs::remove_file(new[2].file.as_ref().unwrap().0.path()).unwrap();
        assert!(replace_all(new, &[path("b")]).unwrap_err().to_string().contains("/c: "));
        assert_eq!(contents(folder.path()), old);

        // A stale file that cannot be removed.
        fs::create_dir(path("stale")).unwrap();
        fs::write(path("stale/file"), "").unwrap();
        let new = vec![staged(&path("a"), "new"), staged(&path("b"), "new")];
        assert!(replace_all(new, &[path("c"), path("stale")]).is_err());
        fs::remove_dir_all(path("stale")).unwrap();
        assert_eq!(contents(folder.path()), old);
    }
}
