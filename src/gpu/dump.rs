//! Dumps of the WGSL that the shader compiler gets: `HSAD_DUMP_WGSL`, see [`super`].

use std::{fs, io, path::Path, path::PathBuf};

use crate::fnv::fnv1a;

/// Writes `text` of stage `name` to the folder that `HSAD_DUMP_WGSL` names, if it is set.
pub(super) fn dump(name: &str, text: &str) {
    let Some(folder) = std::env::var_os("HSAD_DUMP_WGSL").filter(|folder| !folder.is_empty()) else { return };
    if let Err(error) = write(Path::new(&folder), name, text) {
        log::warn!("HSAD_DUMP_WGSL: {name} is not written to {}: {error}", crate::error::shown(Path::new(&folder)));
    }
}

/// Writes `text` to `<folder>/<name>-<FNV-1a of text>.wgsl`, and creates the folder. Each variant of a stage has its
/// own file, written again each time it is compiled.
fn write(folder: &Path, name: &str, text: &str) -> io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let file = folder.join(format!("{name}-{:016x}.wgsl", fnv1a(text.bytes())));
    fs::write(&file, text)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_one_file_in_a_new_folder() {
        let temporary = tempfile::tempdir().expect("a temporary folder");
        let folder = temporary.path().join("new").join("folder");
        let file = write(&folder, "census", "foobar").expect("written");
        assert_eq!(file, folder.join("census-85944171f73967e8.wgsl"));
        assert_eq!(write(&folder, "census", "foobar").expect("written"), file);
        assert_ne!(write(&folder, "census", "another variant").expect("written"), file);
        assert_eq!(fs::read_to_string(&file).expect("a file"), "foobar");
        assert_eq!(fs::read_dir(&folder).expect("the folder").count(), 2);
    }

    #[test]
    fn a_folder_that_cannot_be_is_an_error() {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        assert!(write(file.path(), "census", "text").is_err());
    }
}
