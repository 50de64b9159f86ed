//! hsad in someone else's application: their device, their resources, their encoder, their error handler.
#![cfg(feature = "cli")]

mod application;
mod errors;
mod results;
mod sharing;
mod sparse;
