//! The scenes of an evaluation.

use std::path::{Path, PathBuf};

use hsad::{Error, Result, eval::scene::SceneFiles};

use super::truth_scale::TruthOptions;

/// All scenes in `paths`, the truth in the unit that the options tell, and an error for each path without a scene.
///
/// # Errors
/// As [`collect`].
pub fn find(paths: &[PathBuf], truth: TruthOptions) -> Result<(Vec<SceneFiles>, Vec<Error>)> {
    collect(paths, |path| in_folder(path, truth), |scene| &scene.name)
}

/// The scenes at `path`.
///
/// # Errors
/// As [`SceneFiles::find`].
pub fn in_folder(path: &Path, truth: TruthOptions) -> Result<Vec<SceneFiles>> {
    let scaled = |scene: SceneFiles| match truth.truth_scale {
        Some(scale) => scene.with_truth_scale(scale),
        None => scene,
    };
    Ok(SceneFiles::find(path)?.into_iter().map(scaled).collect())
}

/// The items that `find` finds in all paths, and an error for each path where it fails.
///
/// # Errors
/// [`Error::Parameter`] if two items have the same name, which identifies results.
pub fn collect<T>(
    paths: &[PathBuf],
    find: impl Fn(&Path) -> Result<Vec<T>>,
    name: impl Fn(&T) -> &str,
) -> Result<(Vec<T>, Vec<Error>)> {
    let (mut all, mut failures): (Vec<T>, Vec<Error>) = Default::default();
    for path in paths {
        match find(path) {
            Ok(found) => all.extend(found),
            Err(error) => failures.push(error),
        }
    }
    for (index, one) in all.iter().enumerate() {
        if all[..index].iter().any(|other| name(other) == name(one)) {
            return Err(Error::Parameter {
                name: "SCENE",
                value: format!("the name of two scenes, '{}'", name(one)),
                expected: "each scene needs a name of its own: evaluate them one after the other".into(),
            });
        }
    }
    Ok((all, failures))
}
