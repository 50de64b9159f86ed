//! Terminal output: results on stdout; errors, warnings and progress on stderr.

use std::{
    borrow::Cow,
    fmt::Display,
    io::{self, Write},
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread,
    time::Duration,
};

use hsad::pipeline::{Activity, Step};
use indicatif::{ProgressBar, ProgressStyle};

use super::wording::in_options;

/// Prints one line that says why the work failed.
pub fn error(error: &anyhow::Error) {
    print_line("error", &described(error));
}

/// Why work failed, in words of the command line.
pub fn described(error: &anyhow::Error) -> String {
    error.downcast_ref().map_or_else(|| format!("{error:#}"), in_options)
}

/// Prints one line about a doubt that the result itself does not show.
pub fn warning(text: impl Display) {
    print_line("warning", &text.to_string());
}

/// Prints one line on stderr without a prefix.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints `kind: text` on one line of stderr; a failure to write there has no one left to read it and is ignored.
fn print_line(kind: &str, text: &str) {
    let _ = writeln!(io::stderr(), "{kind}: {}", one_line(text));
}

/// Joins a text into one line without control characters: drivers report in paragraphs, and a file name can hold any
/// character.
fn one_line(text: &str) -> String {
    text.split(|c: char| c.is_control()).map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Prints results. A reader that closes the pipe early (`| head`) is no failure.
pub fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Time between two looks of the spinner.
const TICK: Duration = Duration::from_millis(100);

/// Progress line on stderr; nothing is shown if stderr is no terminal.
pub struct Progress {
    bar: ProgressBar,
    /// Ends the thread that turns the spinner when it is dropped; `None` without such a thread.
    _ticker: Option<Sender<()>>,
}

impl Progress {
    /// Starts a progress line; with `quiet` nothing is shown.
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix}{msg} ({elapsed})") {
            bar.set_style(style);
        }
        let ticker = if bar.is_hidden() { None } else { ticker(&bar) };
        Self { bar, _ticker: ticker }
    }

    /// Sets the piece of work, `number` out of `of`, that the following steps belong to.
    pub fn piece(&self, name: &str, number: usize, of: usize) {
        self.bar.set_prefix(format!("{} ({number} of {of}): ", one_line(name)));
    }

    /// Shows the activity that begins.
    pub fn begin(&self, what: impl Into<Cow<'static, str>>) {
        self.bar.set_message(what);
    }

    /// Clears the progress line while `print` writes, so that the two do not overlap.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Shows the share of the dense step that is done, 0 to 1.
    pub fn share(&self, share: f32) {
        self.begin(format!("matching every pixel, {:.0} %", 100.0 * share));
    }

    /// Shows the activity of a task that begins.
    pub fn activity(&self, activity: Activity) {
        match activity {
            Activity::Rectifying => self.begin("rectifying"),
            Activity::LookingForMirrorImage => self.begin("looking for a mirror image"),
            Activity::Step(step) => self.step(step),
        }
    }

    /// Shows the pipeline step that begins.
    pub fn step(&self, step: Step) {
        self.begin(match step {
            Step::Luma => "bringing the pictures to the device",
            Step::Features => "finding interest points",
            Step::Seeding => "matching interest points",
            Step::Dense => "matching every pixel",
        });
    }
}

/// Starts a thread that turns the spinner of `bar`, not indicatif's own, which panics where no thread can be spawned: there
/// the line stands still between steps.
fn ticker(bar: &ProgressBar) -> Option<Sender<()>> {
    let (end, ended) = channel();
    let bar = bar.clone();
    let turn = move || {
        while ended.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            bar.tick();
        }
    };
    thread::Builder::new().name("progress".into()).spawn(turn).is_ok().then_some(end)
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
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
