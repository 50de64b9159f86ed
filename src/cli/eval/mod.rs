mod change;
mod dense;
mod features;
mod kept;
mod paper;
mod scenes;

use std::fmt::Display;

use anyhow::anyhow;
use clap::{Args, Subcommand};

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
