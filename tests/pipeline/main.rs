//! The way from two pictures to a map, in its steps and as a whole. One program, since each that links the library takes time.
#![cfg(feature = "cli")]

mod loading;
mod matching;
mod pair;
#[path = "../../examples/render_scenes/renderer/mod.rs"]
mod renderer;
mod runs;
mod scenes;
mod seeding;
mod wide_baseline;

/// A folder below `../shared/data`; `None`, and told, where it is absent.
fn real(name: &str) -> Option<std::path::PathBuf> {
    let folder = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data")).join(name);
    if !folder.is_dir() {
        eprintln!("skipped: {} is absent", folder.display());
        return None;
    }
    Some(folder)
}
