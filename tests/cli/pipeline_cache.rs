//! The pipeline cache that the program leaves in the user's cache folder.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use crate::common::{folder, hsad, scene};

/// Finds features with the user's cache in `cache`; the driver keeps its own cache where it is. Returns what the program
/// prints to standard error.
fn features(cache: &Path) -> String {
    let mut command = hsad();
    if let Some(drivers) = env::var_os("MESA_SHADER_CACHE_DIR")
        .or_else(|| env::var_os("XDG_CACHE_HOME"))
        .or_else(|| env::var_os("HOME").map(|home| Path::new(&home).join(".cache").into()))
    {
        command.env("MESA_SHADER_CACHE_DIR", drivers);
    }
    command.env("XDG_CACHE_HOME", cache).args(["features", "-q"]).arg(scene("weak", "left.png"));
    let output = command.assert().success().get_output().clone();
    String::from_utf8(output.stderr).expect("text")
}

fn files(cache: &Path) -> Vec<PathBuf> {
    fs::read_dir(cache.join("hsad")).expect("a folder").map(|entry| entry.expect("an entry").path()).collect()
}

#[test]
fn compiled_pipelines_are_kept_whole_or_not_at_all() {
    let cache = folder();
    features(cache.path());
    let [file] = &files(cache.path())[..] else { panic!("{:?}", files(cache.path())) };
    assert!(file.extension().is_some_and(|extension| extension == "pipelines"), "{}", file.display());
    let kept = fs::read(file).expect("the cache");
    assert!(kept.starts_with(concat!("hsad ", env!("CARGO_PKG_VERSION"), "; ").as_bytes()));
    // Another version's cache, and a damaged one, are replaced.
    let damaged = [&kept[..kept.len() - 1], b"?"].concat();
    for old in [&b"hsad 0.0.1; another driver\n0123456789abcdef\n"[..], &damaged] {
        fs::write(file, old).expect("a file");
        features(cache.path());
        assert_eq!(fs::read(file).expect("the cache"), kept);
        assert_eq!(files(cache.path()).len(), 1);
    }
}

#[test]
fn a_cache_that_cannot_be_written_is_done_without() {
    let cache = folder();
    fs::write(cache.path().join("hsad"), "a file where the folder should be").expect("a file");
    assert_eq!(features(cache.path()), "");
}
