//! The subcommands of `hsad`, one file each, and their shared modules.

mod batch;
mod bench;
mod cache;
mod cloud;
mod completions;
mod demo;
mod depth;
mod devices;
mod doubts;
mod earlier_set;
mod eval;
mod features;
pub mod interruption;
mod job;
pub mod logging;
mod man;
mod match_views;
mod matches;
mod names;
mod options;
pub mod out_of_memory;
mod output;
mod products;
mod recipe;
mod rectification;
mod rectify;
mod report;
mod summary;
pub mod terminal;
mod threads;
mod tune;
mod verify;
mod view_files;
mod way;
mod wording;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use doubts::{NoDepth, NotTrusted};

const EXIT_CODES: &str = "\
Exit codes:
  0  success
  1  failure: a file, a picture or a device is missing or unusable
  2  usage: an unknown option, or a value outside its range
  3  the pair is not rectified and cannot be (hsad match --force matches it all the same)
  4  the map was written, but is not to be trusted (hsad match --force accepts it)
  5  the map was written, but not the depth that a calibration asked for (hsad match --force accepts it)
130  interrupted: no incomplete files are left behind";

/// Stereo depth from two photographs, on any GPU
#[derive(Parser)]
#[command(version, after_help = EXIT_CODES, subcommand_required = true, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Match(Box<match_views::Match>),
    Rectify(rectify::Rectify),
    Features(features::Features),
    Devices(devices::Devices),
    Demo(demo::Demo),
    Eval(eval::Eval),
    Batch(Box<batch::Batch>),
    Verify(verify::Verify),
    Bench(bench::Bench),
    Tune(tune::Tune),
    Completions(completions::Completions),
    Man(man::Manual),
}

impl Cli {
    /// Reads the command line, and whether it asks for errors only. A command line that is wrong ends the program.
    pub fn parse_with_verbosity() -> (Self, bool) {
        let matches = Self::command().get_matches();
        match Self::from_arg_matches(&matches) {
            Ok(command) => (command, is_quiet(&matches)),
            Err(error) => error.format(&mut Self::command()).exit(),
        }
    }

    /// Runs the subcommand.
    pub fn run(self) -> anyhow::Result<()> {
        interruption::clean_up_when_interrupted()?;
        threads::start()?;
        match self.command {
            Command::Match(command) => command.run(),
            Command::Rectify(command) => command.run(),
            Command::Features(command) => command.run(),
            Command::Devices(command) => command.run(),
            Command::Demo(command) => command.run(),
            Command::Eval(command) => command.run(),
            Command::Batch(command) => command.run(),
            Command::Verify(command) => command.run(),
            Command::Bench(command) => command.run(),
            Command::Tune(command) => command.run(),
            Command::Completions(command) => command.run(),
            Command::Man(command) => command.run(),
        }
    }
}

/// Whether a subcommand has the flag `--quiet`.
fn is_quiet(matches: &ArgMatches) -> bool {
    matches.try_get_one("quiet").is_ok_and(|quiet| quiet == Some(&true))
        || matches.subcommand().is_some_and(|(_, matches)| is_quiet(matches))
}

/// The exit code that [`EXIT_CODES`] promises for an error.
pub fn exit_code(error: &anyhow::Error) -> i32 {
    if error.is::<NotTrusted>() {
        return NotTrusted::EXIT_CODE;
    }
    if error.is::<NoDepth>() {
        return NoDepth::EXIT_CODE;
    }
    if let Some(shortfall) = error.downcast_ref::<batch::Shortfall>() {
        return shortfall.exit_code();
    }
    match error.downcast_ref() {
        Some(hsad::Error::Parameter { .. }) => 2,
        Some(hsad::Error::NotRectified { .. } | hsad::Error::NotRectifiable { .. }) => 3,
        _ => 1,
    }
}
