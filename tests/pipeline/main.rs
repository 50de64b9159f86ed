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
