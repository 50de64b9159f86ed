//! The scenes that an evaluation is about.

use std::path::PathBuf;

use hsad::{Error, Result, eval::scene::SceneFiles};

/// All scenes, and what is wrong with the paths that hold none.
///
/// # Errors
/// [`Error::Parameter`] if two have one name, which results are told apart by.
pub fn find(paths: &[PathBuf]) -> Result<(Vec<SceneFiles>, Vec<Error>)> {
    let (mut scenes, mut failures): (Vec<SceneFiles>, Vec<Error>) = Default::default();
    for path in paths {
        match SceneFiles::find(path) {
            Ok(found) => scenes.extend(found),
            Err(error) => failures.push(error),
        }
    }
    for (index, scene) in scenes.iter().enumerate() {
        if scenes[..index].iter().any(|other| other.name == scene.name) {
            return Err(Error::Parameter {
                name: "SCENE",
                value: format!("the name of two scenes, '{}'", scene.name),
                expected: "each needs a name of its own: evaluate them one after the other".into(),
            });
        }
    }
    Ok((scenes, failures))
}
