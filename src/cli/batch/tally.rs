//! What became of the pairs so far: progress on a terminal, lines of JSON elsewhere, and the summary.

use std::{
    io::{self, IsTerminal},
    path::Path,
    time::Duration,
};

use hsad::shown;
use indicatif::{ProgressBar, ProgressStyle};

use super::{
    super::terminal,
    load::Shares,
    record::{Finished, Record, Stages, Status},
};

/// Names of pairs that the summary lists at most per status.
const LISTED: usize = 10;

/// The pairs by their status.
pub struct Tally {
    /// How many pairs there are, if that is known.
    expected: Option<usize>,
    /// Pairs that earlier runs have finished.
    earlier: usize,
    /// Pairs by the number of [`Status::ALL`].
    counts: [usize; 3],
    /// The first names and reasons of those that are not simply done, by the number of [`Status::ALL`].
    listed: [Vec<(String, String)>; 3],
    /// Times of the stages of all pairs together.
    stages: Stages,
    /// What the summary says of the run's time.
    load: String,
    /// What the summary says of frames that are in no pair.
    left_out: String,
    bar: ProgressBar,
    /// Whether records are printed.
    prints: bool,
    quiet: bool,
}

impl Tally {
    /// For as many pairs as `expected`, if that is known; with `quiet` nothing is shown.
    pub fn new(expected: Option<usize>, quiet: bool) -> Self {
        let (bar, template) = match expected {
            _ if quiet => (ProgressBar::hidden(), ""),
            Some(all) => (ProgressBar::new(all as u64), "{wide_bar} {pos} of {len}, {per_sec}, {eta} left {msg}"),
            None => (ProgressBar::new_spinner(), "{spinner} {pos}, {per_sec} {msg}"),
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let prints = !quiet && !io::stdout().is_terminal();
        Self {
            expected,
            earlier: 0,
            counts: [0; 3],
            listed: Default::default(),
            stages: Stages::default(),
            load: String::new(),
            left_out: String::new(),
            bar,
            prints,
            quiet,
        }
    }

    /// Pairs so far.
    pub fn all(&self) -> usize {
        self.counts.iter().sum()
    }

    fn note(&mut self, status: Status, name: &str, reason: Option<&str>) {
        let place = Status::ALL.iter().position(|known| *known == status).unwrap_or(0);
        self.counts[place] += 1;
        if status != Status::Done && self.listed[place].len() < LISTED {
            self.listed[place].push((name.into(), reason.unwrap_or("unknown").into()));
        }
    }

    /// Counts a pair that an earlier run has finished.
    pub fn count_earlier(&mut self, name: &str, finished: &Finished) {
        self.earlier += 1;
        self.note(finished.status, name, finished.reason.as_deref());
        if let Some(all) = self.expected {
            self.bar.set_length((all - self.earlier) as u64);
        }
    }

    /// Counts a pair, and tells of it.
    ///
    /// # Errors
    /// [`hsad::Error::Io`] if standard output cannot be written.
    pub fn count(&mut self, record: &Record) -> hsad::Result<()> {
        self.note(record.status(), record.name(), record.reason());
        self.stages.add(record);
        self.bar.inc(1);
        let [_, doubtful, failed] = self.counts;
        if doubtful + failed > 0 {
            self.bar.set_message(format!("({failed} failed, {doubtful} doubtful)"));
        }
        if !self.prints {
            return Ok(());
        }
        let printed = terminal::print(&format!("{}\n", record.to_json()));
        printed.map_err(|source| hsad::Error::Io { path: "standard output".into(), source })
    }

    /// Notes how long the run took, and how busy it kept the machine.
    pub fn note_load(&mut self, time: Duration, shares: &Shares) {
        let (here, seconds) = (self.all() - self.earlier, time.as_secs_f64());
        let percent = |share: f64| 100.0 * share;
        self.load = format!("\n{here} in {seconds:.1} s, {:.2} per second", here as f64 / seconds.max(1e-9));
        if let Some(share) = shares.processors {
            self.load += &format!("; {:.0} % of the processors' time", percent(share));
        }
        if let Some(share) = shares.device {
            self.load += &format!("; waiting for the device for {:.0} % of it", percent(share));
        }
        if let Some(mean) = self.stages.mean() {
            self.load += &format!("\nseconds per pair: {mean}");
        }
    }

    /// Notes which frames are in no pair.
    pub fn note_left_out(&mut self, text: Option<String>) {
        self.left_out = text.map_or_else(String::new, |text| format!("\n{text}"));
    }

    /// Ends the progress line and prints the summary.
    ///
    /// # Errors
    /// Those of standard output.
    pub fn finish(&self, journal: &Path) -> io::Result<()> {
        self.bar.finish_and_clear();
        if self.quiet {
            return Ok(());
        }
        let [done, doubtful, failed] = self.counts;
        let mut text = format!("{} pairs: {done} done, {doubtful} doubtful, {failed} failed", self.all());
        if self.earlier > 0 {
            text += &format!("; {} by earlier runs", self.earlier);
        }
        text += &self.load;
        text += &self.left_out;
        for ((status, count), listed) in Status::ALL.iter().zip(self.counts).zip(&self.listed).skip(1) {
            for (name, reason) in listed {
                text += &format!("\n  {} {}: {}", status.name(), shown(Path::new(name)), shown(Path::new(reason)));
            }
            if count > listed.len() {
                text += &format!("\n  and {} more {}", count - listed.len(), status.name());
            }
        }
        text += &format!("\n{} has all\n", shown(journal));
        // Standard output has the records, where they are printed.
        if self.prints {
            terminal::note(text.trim_end());
            return Ok(());
        }
        terminal::print(&text)
    }

    /// What falls short, and the exit code that says so.
    pub fn shortfall(&self) -> Option<(String, i32)> {
        let [_, doubtful, failed] = self.counts;
        match (failed, doubtful) {
            (0, 0) => None,
            (0, _) => Some((format!("{doubtful} of {} maps are doubtful; their files were written", self.all()), 4)),
            _ => Some((format!("{failed} of {} pairs failed", self.all()), 1)),
        }
    }
}
