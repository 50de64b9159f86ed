//! Disparity maps of other programs: `--disparity NAME=FILE`.

use std::path::{Path, PathBuf};

use hsad::{Error, Result, report::ResultFile};

use super::OURS;

/// Placeholder of the scene's name in FILE.
const SCENE: &str = "{scene}";

/// File names in a scene's output folder, which the folder of another program must not take.
const RESULTS: [&str; 4] = [ResultFile::Disparities.name(), "error.png", "figure.png", "result.json"];

/// The maps of another program, one per scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SuppliedMaps {
    /// Name of the program.
    pub name: String,
    file: String,
}

impl SuppliedMaps {
    /// Parses `NAME=FILE`.
    ///
    /// # Errors
    /// A message that says what is missing.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        let (name, file) = text.split_once('=').ok_or("expected NAME=FILE, for example sgbm=sgbm.pfm")?;
        // The name becomes a folder name.
        let is_usable = !name.starts_with('.') && !name.contains(['/', '\\']) && !name.contains(char::is_control);
        if name.is_empty() || !is_usable {
            return Err(format!("'{name}' is not a valid name: it must not be empty, begin with '.' or contain '/'"));
        }
        if name == OURS || RESULTS.contains(&name) {
            return Err(format!(
                "'{name}' is the name of this program or of one of its result files: choose another name"
            ));
        }
        if file.is_empty() {
            return Err("the file name after '=' is missing".into());
        }
        Ok(Self { name: name.into(), file: file.into() })
    }

    /// Path of the map of `scene`.
    pub fn path(&self, scene: &str) -> PathBuf {
        Path::new(&self.file.replace(SCENE, scene)).into()
    }
}

/// Refuses duplicate names, and one file for several scenes.
///
/// # Errors
/// [`Error::Parameter`].
pub fn check(maps: &[SuppliedMaps], scenes: usize) -> Result<()> {
    let refused = |maps: &SuppliedMaps, expected: String| {
        Err(Error::Parameter { name: "disparity", value: format!("{}={}", maps.name, maps.file), expected })
    };
    for (index, this) in maps.iter().enumerate() {
        if maps[..index].iter().any(|other| other.name == this.name) {
            return refused(this, format!("there is another '{}': give each program a name of its own", this.name));
        }
        if scenes > 1 && !this.file.contains(SCENE) {
            let example = format!("{}=maps/{SCENE}.pfm", this.name);
            return refused(
                this,
                format!("there are {scenes} scenes: tell their files apart by {SCENE}, as in {example}"),
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::slice;

    use super::*;

    #[test]
    fn names_and_files() {
        let given = SuppliedMaps::parse("sgbm=maps/{scene}/a=b.png").unwrap();
        assert_eq!((&*given.name, given.path("Art")), ("sgbm", PathBuf::from("maps/Art/a=b.png")));
        for text in ["64", "=a", "a=", "a/b=c", "..=c", "hsad=c", "result.json=c", "a\nb=c"] {
            assert!(SuppliedMaps::parse(text).is_err(), "{text}");
        }
        let alone = SuppliedMaps::parse("sgbm=map.pfm").unwrap();
        check(slice::from_ref(&alone), 1).unwrap();
        check(slice::from_ref(&given), 9).unwrap();
        let message = |maps: &[SuppliedMaps], scenes| check(maps, scenes).unwrap_err().to_string();
        assert!(message(slice::from_ref(&alone), 2).contains("as in sgbm=maps/{scene}.pfm"));
        assert!(message(&[alone, given], 1).contains("another 'sgbm'"));
    }
}
