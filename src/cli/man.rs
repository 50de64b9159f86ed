//! `hsad man`: manual pages.

use std::{io, path::PathBuf};

use anyhow::Context;
use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;

use super::{Cli, output::Output, terminal};

/// Print the manual page, or write one page per command
///
/// Without DIR the page of hsad itself goes to the terminal, as roff. With DIR each command gets a page of its own there:
/// hsad.1, hsad-match.1, hsad-eval-dense.1 and so on; the pages appear all together or not at all.
#[derive(Args)]
#[command(after_help = "Examples:
  hsad man | man -l -
  hsad man ~/.local/share/man/man1")]
pub struct Manual {
    /// Folder for the pages, created if need be
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl Manual {
    /// Prints or writes the pages.
    pub fn run(self) -> anyhow::Result<()> {
        let mut program = Cli::command().disable_help_subcommand(true);
        // The names of the subcommands' pages, hsad-match and the like, and the options that all commands have.
        program.build();
        let Some(folder) = self.folder else {
            let mut page = Vec::new();
            Man::new(program).render(&mut page)?;
            let page = String::from_utf8(page).context("the manual page is no UTF-8")?;
            return Ok(terminal::print(&page)?);
        };
        let mut output = Output::open(&folder)?;
        add_pages(&mut output, program)?;
        Ok(output.finish()?)
    }
}

/// Adds the page of `command`, and those of its subcommands.
fn add_pages(output: &mut Output, command: Command) -> hsad::Result<()> {
    for subcommand in command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set()) {
        add_pages(output, subcommand.clone())?;
    }
    let page = Man::new(command);
    // `Output` keeps names for as long as the program runs, which here ends with the pages.
    let name: &'static str = page.get_filename().leak();
    output.add(name, |out| -> io::Result<()> { page.render(out) })
}
