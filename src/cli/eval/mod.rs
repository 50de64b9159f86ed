//! `hsad eval`: how good results are, on data with known truth.

mod dense;

use clap::{Args, Subcommand};

/// Measure how good results are, on data with known truth
#[derive(Args)]
pub struct Eval {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Dense(Box<dense::Dense>),
}

impl Eval {
    /// Does what was asked.
    pub fn run(self) -> anyhow::Result<()> {
        match self.what {
            What::Dense(command) => command.run(),
        }
    }
}
