//! How far `trust`, the rows, the disparity range and the confidences can be relied on: scenes with known truth, and the same
//! scenes made worse, matched by the pipeline. Prints tables in Markdown; `docs/trust.md` has the results.
//!
//! `cargo run --release --example trust -- [TABLE...] [SCENE...]`, with the tables `trust`, `rows`, `ranges`, `confidence`, and
//! a `SCENE` as for `hsad eval dense`. The default is all tables, on the scenes of `data/`. `confidence data/planes` takes a
//! few seconds.
#![expect(clippy::print_stdout, reason = "a measurement prints")]

mod confidence;
mod markdown;
mod matched;
mod ranges;
mod rows;
mod scores;
mod trust;
mod variant;

use std::{path::Path, process::ExitCode};

use hsad::{
    Backend, DeviceChoice,
    dense::View,
    eval::scene::{Scene, SceneFiles},
};

type AnyError = Box<dyn std::error::Error>;

/// A scene and its name.
struct Named {
    name: String,
    scene: Scene,
}

/// Prints one table.
type Table = fn(&Backend, &[Named]) -> Result<(), AnyError>;

const TABLES: [(&str, Table); 4] =
    [("trust", trust::print), ("rows", rows::print), ("ranges", ranges::print), ("confidence", confidence::print)];

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), AnyError> {
    let (tables, mut folders): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| TABLES.iter().any(|(name, _)| name == argument));
    if folders.is_empty() {
        folders.push("data".into());
    }
    let mut scenes = Vec::new();
    for folder in &folders {
        for files in SceneFiles::find(Path::new(folder))? {
            scenes.push(Named { scene: files.read(View::Left)?, name: files.name });
        }
    }
    let backend = Backend::open(&DeviceChoice::Best)?;
    println!("On {}, {}.", backend.name(), backend.driver());
    let is_asked = |name: &str| tables.is_empty() || tables.iter().any(|table| table == name);
    TABLES.iter().filter(|(name, _)| is_asked(name)).try_for_each(|(_, print)| print(&backend, &scenes))
}
