//! Renders the stereo pairs that this project ships as test scenes, with exact ground truth.
//!
//! ```text
//! cargo run --example render_scenes -- data
//! cargo run --example render_scenes -- data planes
//! ```
//!
//! The first argument is the output folder, the others are the names of scenes [default: all].

mod renderer;

use std::path::PathBuf;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next().map(PathBuf::from) else {
        anyhow::bail!("no folder to write to: cargo run --example render_scenes -- data [scene...]");
    };
    let selected: Vec<String> = arguments.collect();
    let scenes = renderer::scenes();
    if let Some(unknown) = selected.iter().find(|name| !scenes.iter().any(|scene| scene.name == **name)) {
        let known: Vec<_> = scenes.iter().map(|scene| scene.name).collect();
        anyhow::bail!("there is no scene '{unknown}': the scenes are {}", known.join(", "));
    }
    for scene in scenes.iter().filter(|scene| selected.is_empty() || selected.iter().any(|name| name == scene.name)) {
        let into = folder.join(scene.name);
        renderer::write(scene, &renderer::render(scene), &into)?;
        eprintln!("{}", into.display());
    }
    Ok(())
}
