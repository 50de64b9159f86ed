mod change;
mod dense;
mod features;
mod moved;
mod paper;
mod saved_results;
mod scenes;
mod truth_scale;

use std::fmt::Display;

use anyhow::anyhow;
use clap::{Args, Subcommand};

use crate::cli::terminal;

/// Measure the quality of results on data with ground truth
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
    /// Runs the evaluation.
    pub fn run(self) -> anyhow::Result<()> {
        match self.evaluation {
            Evaluation::Dense(command) => command.run(),
            Evaluation::Features(command) => command.run(),
            Evaluation::Paper(command) => command.run(),
        }
    }
}

/// Prints one line for each failure but the last, and returns the last one as the error of the program.
fn report_failures(failures: &[impl Display]) -> anyhow::Result<()> {
    let Some((last, others)) = failures.split_last() else { return Ok(()) };
    others.iter().for_each(|failure| terminal::error(&anyhow!("{failure}")));
    Err(anyhow!("{last}"))
}
