//! A pair of a batch, and the names of its results.

use std::{
    collections::HashMap,
    path::{Component, Path, PathBuf},
};

use anyhow::{Result, bail};

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

/// Checks that each pair has a folder of its own below the output folder.
///
/// # Errors
/// The name that has not, and what it can be.
pub fn check_names(pairs: &[Pair]) -> Result<()> {
    let mut known = HashMap::new();
    for pair in pairs {
        let path = Path::new(&pair.name);
        let is_below = path.components().all(|part| matches!(part, Component::Normal(_)));
        if pair.name.is_empty() || !is_below {
            bail!("the name '{}' of the pair {} is no folder in the output folder", pair.name, pair.left.display());
        }
        if let Some(other) = known.insert(path, &pair.left) {
            bail!(
                "the pairs {} and {} have the same name '{}': give each a name of its own (a column 'name' in the list)",
                other.display(),
                pair.left.display(),
                pair.name
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(name: &str) -> Pair {
        Pair { name: name.into(), left: format!("{name}.png").into(), right: None, calibration: None }
    }

    #[test]
    fn results_stay_in_the_output_folder_and_apart() {
        assert!(check_names(&[pair("a"), pair("b/a"), pair("a b")]).is_ok());
        for wrong in ["", "..", "../a", "/a", "a/../b", "."] {
            assert!(check_names(&[pair(wrong)]).is_err(), "{wrong}");
        }
        let error = check_names(&[pair("a"), pair("b"), pair("a")]).expect_err("the same name").to_string();
        assert!(error.contains("the same name 'a'"), "{error}");
    }
}
