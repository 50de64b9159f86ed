//! hsad embedded in an application, with the application's device, resources, encoder and error handler.
#![cfg(feature = "cli")]

mod application;
mod compilation;
mod errors;
mod rectifying;
mod results;
mod sharing;
mod sources;
mod sparse;
