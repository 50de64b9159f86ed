//! What people see: results on stdout; errors, warnings and progress on stderr.

use std::{
    borrow::Cow,
    fmt::Display,
    io::{self, Write},
    time::Duration,
};

use hsad::pipeline::Step;
use indicatif::{ProgressBar, ProgressStyle};

/// One line that says why the work failed.
pub fn error(error: &anyhow::Error) {
    // The library's errors know no options, since the page in a browser shows them as well.
    let option = match error.downcast_ref() {
        Some(hsad::Error::NotRectified { .. }) => " with --force",
        _ => "",
    };
    print_line("error", &format!("{error}{option}"));
}

/// One line about something that the result does not show by itself.
pub fn warning(text: impl Display) {
    print_line("warning", &text.to_string());
}

/// One line that belongs to no result.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Where stderr itself is gone there is nobody left to tell.
fn print_line(kind: &str, text: &str) {
    let _ = writeln!(io::stderr(), "{kind}: {}", one_line(text));
}

/// Messages of drivers come in paragraphs, and a file's name can hold anything.
fn one_line(text: &str) -> String {
    text.split(|c: char| c.is_control()).map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Prints results. A reader who has seen enough (`| head`) is no failure.
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// What is being done, on a terminal; nothing where stderr is no terminal.
pub struct Progress(ProgressBar);

impl Progress {
    /// Nothing is shown where `quiet`.
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}{msg} ({elapsed})") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Says which of several pieces of work the steps belong to from now on.
    pub fn piece(&self, name: &str, number: usize, of: usize) {
        self.0.set_prefix(format!("{} ({number} of {of}): ", one_line(name)));
    }

    /// Says what begins now.
    pub fn begin(&self, what: impl Into<Cow<'static, str>>) {
        self.0.set_message(what);
    }

    /// Prints something meanwhile, without it and what is shown getting in each other's way.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }

    /// Says which step of the pipeline begins now.
    pub fn step(&self, step: Step) {
        self.begin(match step {
            Step::Luma => "bringing the pictures to the device",
            Step::Features => "finding interest points",
            Step::Seeding => "matching interest points",
            Step::Dense => "matching every pixel",
        });
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_becomes_one_line() {
        assert_eq!(one_line("the device:\n  no memory\r\n\n\tat all\n"), "the device: no memory at all");
        assert_eq!(one_line("a\x1b[2Jb"), "a [2Jb");
    }
}
