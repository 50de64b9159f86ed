//! What an earlier run left in an output folder, and the lock that keeps other runs out of it.

use std::{
    fs,
    path::{Component, Path, PathBuf},
};

use hsad::report::ResultFile;
use serde_json::Value;

/// The file of a set that lists all files of the set.
pub const REPORT: &str = ResultFile::Report.name();

/// Size beyond which a file named `report.json` is none of ours, in bytes.
const MOST: u64 = 1 << 26;

/// Names of the files in a folder that an earlier run of hsad wrote, as its report lists them.
#[derive(Debug, Default, PartialEq)]
pub struct EarlierSet(Vec<String>);

impl EarlierSet {
    /// The set in `folder`; empty if nothing there is hsad's.
    pub fn read(folder: &Path) -> Self {
        let path = folder.join(REPORT);
        if !fs::metadata(&path).is_ok_and(|found| found.is_file() && found.len() <= MOST) {
            return Self::default();
        }
        let report: Option<Value> = fs::read(path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
        report.as_ref().and_then(Self::of).unwrap_or_default()
    }

    /// The files of a report; `None` if it is none of hsad's.
    fn of(report: &Value) -> Option<Self> {
        report["version"].as_str()?;
        let names = report["files"].as_array()?.iter().map(|name| name.as_str().map(String::from));
        Some(Self(names.collect::<Option<Vec<_>>>()?.into_iter().filter(|name| is_plain(name)).collect()))
    }

    /// Whether hsad wrote the file of this name.
    pub fn contains(&self, name: &str) -> bool {
        self.0.iter().any(|known| known == name)
    }

    /// The regular files of the set in `folder` that are not in `names`.
    pub fn without<'a>(&'a self, folder: &'a Path, names: &'a [&str]) -> impl Iterator<Item = PathBuf> + 'a {
        let others = self.0.iter().filter(|name| !names.contains(&name.as_str()));
        others.map(|name| folder.join(name)).filter(|path| path.symlink_metadata().is_ok_and(|found| found.is_file()))
    }
}

/// Whether a name stays in its folder.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name)
}

/// Keeps other runs out of a folder, until it is dropped.
#[derive(Debug)]
pub struct FolderLock {
    /// The open folder, if its file system has locks.
    #[cfg(unix)]
    _folder: Option<fs::File>,
}

impl FolderLock {
    /// Locks `folder`; `None` if another process holds it. Where folders cannot be locked, nothing is.
    pub fn take(folder: &Path) -> Option<Self> {
        #[cfg(unix)]
        {
            use std::io::ErrorKind;
            let open = fs::File::open(folder).and_then(|file| hsad::io::atomic::try_lock(&file).map(|()| file));
            match open {
                Err(error) if error.kind() == ErrorKind::WouldBlock => None,
                open => Some(Self { _folder: open.ok() }),
            }
        }
        #[cfg(not(unix))]
        {
            let _ = folder;
            Some(Self {})
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_report_tells_the_files_of_its_folder_only() {
        let found = |report: Value| EarlierSet::of(&report).map(|set| set.0);
        let files = json!(["report.json", "../above", "/etc/passwd", "a/b", "..", "", ".", "cloud.ply"]);
        let expected = ["report.json", "cloud.ply"].map(String::from).to_vec();
        assert_eq!(found(json!({ "version": "0.1.0", "files": files })), Some(expected));
        for other in
            [json!({ "files": ["a"] }), json!({ "version": "1", "files": [1] }), json!({ "version": "1" }), json!(7)]
        {
            assert_eq!(found(other), None);
        }
    }

    #[test]
    fn what_is_no_report_lists_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(EarlierSet::read(folder.path()), EarlierSet::default());
        fs::write(folder.path().join(REPORT), "no JSON").unwrap();
        assert_eq!(EarlierSet::read(folder.path()), EarlierSet::default());
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_has_one_lock() {
        let folder = tempfile::tempdir().unwrap();
        let lock = FolderLock::take(folder.path()).unwrap();
        assert!(FolderLock::take(folder.path()).is_none());
        drop(lock);
        assert!(FolderLock::take(folder.path()).is_some());
    }
}
