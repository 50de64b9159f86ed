//! Log records of the library and of wgpu.

use std::env;

use env_logger::{Builder, Env};

use super::terminal;

/// Records that are shown as warnings: a dump that failed, and a pipe that nobody writes.
const SHOWN: &str = "off,hsad::gpu::dump=warn,hsad::io=warn";

/// Shows records that `RUST_LOG` asks for, with their time and place; without it a few as warnings, but none if `is_quiet`: a failure is one
/// message.
pub fn init(is_quiet: bool) {
    if env::var_os(env_logger::DEFAULT_FILTER_ENV).is_some() {
        return Builder::from_env(Env::default()).init();
    }
    let filter = if is_quiet { "off" } else { SHOWN };
    let as_warning = |_: &mut env_logger::fmt::Formatter, record: &log::Record| {
        terminal::warning(record.args());
        Ok(())
    };
    Builder::new().parse_filters(filter).format(as_warning).init();
}
