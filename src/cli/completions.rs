//! `hsad completions`: completion scripts for shells.

use anyhow::Context;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::{Cli, terminal};

/// Print the completion script of a shell
///
/// The script completes commands, options, values of options and file names.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad completions bash > ~/.local/share/bash-completion/completions/hsad
  hsad completions zsh > ~/.zfunc/_hsad
  hsad completions fish > ~/.config/fish/completions/hsad.fish
  hsad completions powershell >> $PROFILE")]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

impl Completions {
    /// Prints the script.
    pub fn run(self) -> anyhow::Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "hsad", &mut script);
        let script = String::from_utf8(script).context("the completion script is no UTF-8")?;
        Ok(terminal::print(&script)?)
    }
}
