//! What an earlier run left in an output folder, and the lock that keeps other runs out of it.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

use super::names::is_ours;

/// Size beyond which a list of files is none of ours, in bytes.
const MOST: u64 = 1 << 26;

/// The field of a list that is true while the files of the set take their places: after a kill, earlier files may lie among them.
pub const UNFINISHED: &str = "unfinished";

/// Names of the files in a folder that an earlier run of hsad wrote, as a file among them lists them.
#[derive(Debug, Default, PartialEq)]
pub struct EarlierSet(Vec<String>);

impl EarlierSet {
    /// The set in `folder` that the file called `list` lists; empty if nothing there is hsad's.
    pub fn read(folder: &Path, list: &str) -> Self {
        let path = folder.join(list);
        if !fs::metadata(&path).is_ok_and(|found| found.is_file() && found.len() <= MOST) {
            return Self::default();
        }
        let listed: Option<Value> = fs::read(path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let names = listed.as_ref().and_then(listed_in);
        // What else is listed is none of ours, whoever wrote the list.
        let ours = names.map(|names| names.into_iter().chain([list]).filter(|name| is_ours(name)));
        Self(ours.into_iter().flatten().map(String::from).collect())
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

/// The files that a report lists, or a result with the hash of each; `None` if it is none of hsad's.
fn listed_in(list: &Value) -> Option<Vec<&str>> {
    list["version"].as_str().or(list["fingerprint"].as_str())?;
    match &list["files"] {
        Value::Array(names) => names.iter().map(Value::as_str).collect(),
        Value::Object(hashes) => Some(hashes.keys().map(String::as_str).collect()),
        _ => None,
    }
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

    use super::{
        super::names::{REPORT, RESULT},
        *,
    };

    /// The set that a file of this name and content lists.
    fn listed(name: &str, content: &str) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), content).unwrap();
        EarlierSet::read(folder.path(), name).0
    }

    #[test]
    fn a_list_tells_files_of_its_folder_that_hsad_writes_and_no_others() {
        let names = ["disparity.pfm", "../cloud.ply", "/etc/passwd", "a/b", "..", "", ".", "thesis.tex", "cloud.ply"];
        let report = json!({ "version": "0.1.0", "files": names });
        assert_eq!(listed(REPORT, &report.to_string()), ["disparity.pfm", "cloud.ply", "report.json"]);
        let result = json!({ "fingerprint": "0a", "files": { "error.png": "01", "thesis.tex": "02" } });
        assert_eq!(listed(RESULT, &result.to_string()), ["error.png", "result.json"]);
    }

    #[test]
    fn what_is_no_list_lists_nothing() {
        let others = [json!({ "files": ["a"] }), json!({ "version": "1", "files": [1] }), json!({ "version": "1" })];
        for other in others.map(|other| other.to_string()).iter().map(String::as_str).chain(["7", "no JSON"]) {
            assert_eq!(listed(REPORT, other), [""; 0], "{other}");
        }
        assert_eq!(EarlierSet::read(Path::new("nowhere"), REPORT), EarlierSet::default());
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
