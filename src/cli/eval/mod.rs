mod change;
mod dense;
mod features;
mod kept;
mod paper;
mod scenes;

use std::{fmt::Display, io, path::Path};

use anyhow::anyhow;
use clap::{Args, Subcommand};
use hsad::{Error, io::atomic::temporary_in};

use crate::cli::terminal;

/// Tell how good results are, on data with known truth
#[derive(Args)]
pub struct Eval {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Dense(Box<dense::Dense>),
    Features(Box<features::Features>),
    Paper(paper::Paper),
}

impl Eval {
    /// Does what was asked.
    pub fn run(self) -> anyhow::Result<()> {
        match self.what {
            What::Dense(command) => command.run(),
            What::Features(command) => command.run(),
            What::Paper(command) => command.run(),
        }
    }
}

/// A line about each failure, the last of which is the program's own.
fn complain(failures: &[impl Display]) -> anyhow::Result<()> {
    let Some((last, others)) = failures.split_last() else { return Ok(()) };
    others.iter().for_each(|failure| terminal::error(&anyhow!("{failure}")));
    Err(anyhow!("{last}"))
}

/// Finds out, before any work, whether a file can be written.
fn check_writable(path: &Path) -> hsad::Result<()> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    // What exists may be a pipe or /dev/stdout, next to which nothing can be made.
    let tried = if path.is_dir() {
        Err(io::ErrorKind::IsADirectory.into())
    } else if path.exists() {
        Ok(())
    } else {
        temporary_in(folder).map(drop)
    };
    tried.map_err(|error| {
        let reason = format!("the file cannot be written ({error}): name another one");
        Error::Io { path: path.into(), source: io::Error::new(error.kind(), reason) }
    })
}
