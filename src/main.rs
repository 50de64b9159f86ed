//! The command line of `hsad`.

mod cli;

use std::io::{self, Write};

use clap::Parser;

#[global_allocator]
static ALLOCATOR: cli::out_of_memory::Allocator = cli::out_of_memory::Allocator;

fn main() {
    without_desktop();
    // Log records of the library and of wgpu are shown only if RUST_LOG asks for them, but for a dump that failed and a
    // pipe that nobody writes: a failure is one message.
    env_logger::Builder::from_env(
        env_logger::Env::default().default_filter_or("off,hsad::gpu::dump=warn,hsad::io=warn"),
    )
    .init();
    let code = match cli::Cli::parse().run() {
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
