//! The names of the pairs of a batch, each of which is a folder of its own in the output folder.

use std::{
    collections::{HashMap, HashSet},
    ffi::{OsStr, OsString},
    fs,
    path::{Component, Path, PathBuf},
};

use anyhow::{Result, bail};
use hsad::{internals::fnv1a, shown};

use super::pair::Pair;

/// The names so far, of which there may be millions: of each pair a number that tells its folder from others is kept, but for accidents.
pub struct Names<'a> {
    output: &'a Path,
    /// Folders that names lie in, below the output folder.
    folders: HashMap<PathBuf, Folder>,
    /// Numbers of the folders of all pairs, and places of the pairs.
    numbers: Vec<(u64, usize)>,
}

/// A folder that names lie in.
struct Folder {
    /// Where it is without links, as far as it is there.
    place: PathBuf,
    /// The links in it: those of an earlier run, or of the user.
    links: HashSet<OsString>,
}

impl<'a> Names<'a> {
    pub fn new(output: &'a Path) -> Self {
        Self { output, folders: HashMap::new(), numbers: Vec::new() }
    }

    /// Takes the name of the next pair.
    ///
    /// # Errors
    /// A name that is no folder in the output folder.
    pub fn add(&mut self, pair: &Pair) -> Result<()> {
        let path = Path::new(&pair.name);
        let is_below = path.components().all(|part| matches!(part, Component::Normal(_)));
        let (Some(last), true) = (path.file_name(), is_below) else {
            let name = shown(path);
            bail!("the name '{name}' of the pair {} is no folder in the output folder", shown(&pair.left));
        };
        let parent = path.parent().unwrap_or(Path::new(""));
        if !self.folders.contains_key(parent) {
            self.folders.insert(parent.into(), Folder::at(&self.output.join(parent)));
        }
        let number = match &self.folders[parent] {
            Folder { links, .. } if links.contains(last) => {
                let place = place(&self.output.join(path));
                number(place.parent().unwrap_or(Path::new("")), place.file_name().unwrap_or_default())
            }
            Folder { place, .. } => number(place, last),
        };
        self.numbers.push((number, self.numbers.len()));
        Ok(())
    }

    /// Checks that each pair has a folder of its own; `pair` makes the pair at a place again.
    ///
    /// # Errors
    /// The first name that is there twice or is the folder of another one by a link, what it can be, and those of `pair`.
    pub fn check(mut self, pair: impl Fn(usize) -> Result<Pair>) -> Result<()> {
        self.numbers.sort_unstable();
        let both = self.numbers.windows(2).filter(|both| both[0].0 == both[1].0).map(|both| [both[0].1, both[1].1]);
        let mut both: Vec<[usize; 2]> = both.collect();
        both.sort_unstable_by_key(|&[_, second]| second);
        for [first, second] in both {
            let (first, second) = (pair(first)?, pair(second)?);
            let [one, other] = [&first, &second].map(|pair| Path::new(&pair.name));
            if one == other {
                bail!(
                    "the pairs {} and {} have the same name '{}': give each a name of its own (a column 'name' in the list)",
                    shown(&first.left),
                    shown(&second.left),
                    shown(other)
                );
            }
            if place(&self.output.join(one)) == place(&self.output.join(other)) {
                bail!(
                    "the names '{}' and '{}' are one folder, {}, by a link: give each pair a folder of its own",
                    shown(one),
                    shown(other),
                    shown(&self.output.join(other))
                );
            }
        }
        Ok(())
    }
}

impl Folder {
    fn at(path: &Path) -> Self {
        let is_link = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|found| found.is_symlink());
        let links = fs::read_dir(path).into_iter().flatten().flatten().filter(is_link);
        Self { place: place(path), links: links.map(|entry| entry.file_name()).collect() }
    }
}

/// A number that the name `last` in a folder without links has in common with no other one, but for accidents.
fn number(folder: &Path, last: &OsStr) -> u64 {
    let parts = [folder.as_os_str(), OsStr::new("/"), last].map(OsStr::as_encoded_bytes);
    fnv1a(parts.into_iter().flatten().copied())
}

/// The folder without links, as far as it is there.
fn place(folder: &Path) -> PathBuf {
    let there = folder.ancestors().find_map(|above| Some((fs::canonicalize(above).ok()?, above)));
    let below = there.and_then(|(there, above)| Some(there.join(folder.strip_prefix(above).ok()?)));
    // In one spelling.
    below.as_deref().unwrap_or(folder).components().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(name: &str) -> Pair {
        Pair { name: name.into(), left: format!("{name}.png").into(), right: None, calibration: None }
    }

    fn check_names(pairs: &[Pair], output: &Path) -> Result<()> {
        let mut names = Names::new(output);
        pairs.iter().try_for_each(|pair| names.add(pair))?;
        names.check(|place| Ok(pairs[place].clone()))
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
            let error = told(&["c", "b", "a"], folder.path());
            assert!(error.contains("'b' and 'a' are one folder"), "{error}");
            assert!(check_names(&[pair("a/1"), pair("b/2"), pair("c")], folder.path()).is_ok());
        }
    }
}
