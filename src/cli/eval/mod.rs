//! `hsad eval`: how good results are, on data with known truth.

mod features;

use clap::{Args, Subcommand};

/// Measure how good results are, on data with known truth
#[derive(Args)]
pub struct Eval {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Features(features::Features),
}

impl Eval {
    /// Measures.
    pub fn run(self) -> anyhow::Result<()> {
        match self.what {
            What::Features(command) => command.run(),
        }
    }
}
