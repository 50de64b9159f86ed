mod change;
mod dense;
mod features;
mod kept;
mod paper;
mod scenes;

use clap::{Args, Subcommand};

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
