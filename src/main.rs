//! The command line of `hsad`.

mod cli;

use std::io::{self, Write};

#[global_allocator]
static ALLOCATOR: cli::out_of_memory::Allocator = cli::out_of_memory::Allocator;

fn main() {
    without_desktop();
    let (command, is_quiet) = cli::Cli::parse_with_verbosity();
    cli::logging::init(is_quiet);
    let code = match command.run() {
        Ok(()) => 0,
        Err(error) => {
            cli::terminal::error(&error);
            cli::exit_code(&error)
        }
    };
    // Results are written by now; what is lost here is text for a reader that is gone.
    io::stdout().flush().ok();
    cli::interruption::exit_at_once(code)
}

/// Keeps Mesa's device-select layer out where there is no desktop: it looks for a compositor, and
/// libwayland then prints 'error: XDG_RUNTIME_DIR is invalid or not set' for each look. All the
/// layer does is sort devices, and `--device` chooses among them here.
fn without_desktop() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: this is the first thing that happens, so no other thread reads the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
