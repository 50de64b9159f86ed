//! A pair of a batch, and the names of its results.

use std::{
    collections::HashMap,
    fs,
    path::{Component, Path, PathBuf},
};

use anyhow::{Result, bail};
use hsad::shown;

/// A pair of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Folder of the results, in the output folder.
    pub name: String,
    /// Left view, or the file with both.
    pub left: PathBuf,
    pub right: Option<PathBuf>,
    /// Calibration of this pair; else that of the batch.
    pub calibration: Option<PathBuf>,
}

impl Pair {
    /// The files of both views, which may be one.
    pub fn files(&self) -> [&Path; 2] {
        [&self.left, self.right.as_ref().unwrap_or(&self.left)]
    }
}

/// Checks that each pair has a folder of its own below the `output` folder.
///
/// # Errors
/// The name that has not, and what it can be.
pub fn check_names(pairs: &[Pair], output: &Path) -> Result<()> {
    let mut known = HashMap::new();
    let mut places = HashMap::new();
    // Links are those of an earlier run, or of the user.
    let may_have_links = output.exists();
    for pair in pairs {
        let path = Path::new(&pair.name);
        let name = shown(path);
        let is_below = path.components().all(|part| matches!(part, Component::Normal(_)));
        if pair.name.is_empty() || !is_below {
            bail!("the name '{name}' of the pair {} is no folder in the output folder", shown(&pair.left));
        }
        if let Some(other) = known.insert(path, &pair.left) {
            bail!(
                "the pairs {} and {} have the same name '{name}': give each a name of its own (a column 'name' in the list)",
                shown(other),
                shown(&pair.left)
            );
        }
        let place = if may_have_links { place(&output.join(path)) } else { None };
        if let Some(other) = place.and_then(|place| places.insert(place, path)) {
            bail!(
                "the names '{}' and '{name}' are one folder, {}, by a link: give each pair a folder of its own",
                shown(other),
                shown(&output.join(path))
            );
        }
    }
    Ok(())
}

/// The folder without links, as far as it is there; `None` if nothing of it is.
fn place(folder: &Path) -> Option<PathBuf> {
    let there = folder.ancestors().find_map(|above| Some((fs::canonicalize(above).ok()?, above)));
    let (there, above) = there?;
    Some(there.join(folder.strip_prefix(above).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(name: &str) -> Pair {
        Pair { name: name.into(), left: format!("{name}.png").into(), right: None, calibration: None }
    }

    #[test]
    fn results_stay_in_the_output_folder_and_apart() {
        let nowhere = Path::new("nowhere");
        assert!(check_names(&[pair("a"), pair("b/a"), pair("a b")], nowhere).is_ok());
        for wrong in ["", "..", "../a", "/a", "a/../b", "."] {
            assert!(check_names(&[pair(wrong)], nowhere).is_err(), "{wrong}");
        }
        let told = |names: &[&str], output: &Path| {
            let pairs: Vec<Pair> = names.iter().map(|name| pair(name)).collect();
            check_names(&pairs, output).expect_err("one folder").to_string()
        };
        let error = told(&["a", "b", "a"], nowhere);
        assert!(error.contains("the same name 'a'"), "{error}");
        assert!(!told(&["a\x1b[2J", "a\x1b[2J"], nowhere).contains('\x1b'), "terminals obey such names");
        #[cfg(unix)]
        {
            let folder = tempfile::tempdir().expect("a folder");
            fs::create_dir(folder.path().join("a")).expect("a folder");
            std::os::unix::fs::symlink("a", folder.path().join("b")).expect("a link");
            let error = told(&["a/1", "c", "b/1"], folder.path());
            assert!(error.contains("'a/1' and 'b/1' are one folder"), "{error}");
            assert!(check_names(&[pair("a/1"), pair("b/2"), pair("c")], folder.path()).is_ok());
        }
    }
}
