mod change;
mod dense;
mod features;
mod saved_results;
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
    evaluation: Evaluation,
}

#[derive(Subcommand)]
enum Evaluation {
    Dense(Box<dense::Dense>),
    Features(Box<features::Features>),
    Paper(paper::Paper),
}

impl Eval {
    /// Does what was asked.
    pub fn run(self) -> anyhow::Result<()> {
        match self.evaluation {
            Evaluation::Dense(command) => command.run(),
            Evaluation::Features(command) => command.run(),
            Evaluation::Paper(command) => command.run(),
        }
    }
}

/// A line about each failure, the last of which is the program's own.
fn report_failures(failures: &[impl Display]) -> anyhow::Result<()> {
    let Some((last, others)) = failures.split_last() else { return Ok(()) };
    others.iter().for_each(|failure| terminal::error(&anyhow!("{failure}")));
    Err(anyhow!("{last}"))
}
