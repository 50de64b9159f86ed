//! What became of the pairs so far: progress on a terminal, lines of JSON elsewhere, and the summary.

use std::{
    io::{self, IsTerminal},
    path::Path,
    time::Duration,
};

use indicatif::{ProgressBar, ProgressStyle};

use super::{
    super::terminal,
    load::Shares,
    record::{Record, Stages, Status},
};

/// Names of pairs that the summary lists at most per status.
const LISTED: usize = 10;

/// The pairs by their status.
pub struct Tally {
    /// How many pairs there are, if that is known.
    expected: Option<usize>,
    /// Pairs that earlier runs have finished.
    earlier: usize,
    /// Names and reasons, by the number of [`Status::ALL`].
    found: [Vec<(String, Option<String>)>; 3],
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
            found: Default::default(),
            stages: Stages::default(),
            load: String::new(),
            left_out: String::new(),
            bar,
            prints,
            quiet,
        }
    }

    /// Pairs so far.
    fn all(&self) -> usize {
        self.found.iter().map(Vec::len).sum()
    }

    fn note(&mut self, record: &Record) {
        let place = Status::ALL.iter().position(|status| *status == record.status()).unwrap_or(0);
        self.found[place].push((record.name().into(), record.reason().map(String::from)));
    }

    /// Counts a pair that an earlier run has finished.
    pub fn count_earlier(&mut self, record: &Record) {
        self.earlier += 1;
        self.note(record);
        if let Some(all) = self.expected {
            self.bar.set_length((all - self.earlier) as u64);
        }
    }

    /// Counts a pair, and tells of it.
    ///
    /// # Errors
    /// [`hsad::Error::Io`] if standard output cannot be written.
    pub fn count(&mut self, record: &Record) -> hsad::Result<()> {
        self.note(record);
        self.stages.add(record);
        self.bar.inc(1);
        let [_, doubtful, failed] = self.found.each_ref().map(Vec::len);
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
        let [done, doubtful, failed] = self.found.each_ref().map(Vec::len);
        let mut text = format!("{} pairs: {done} done, {doubtful} doubtful, {failed} failed", self.all());
        if self.earlier > 0 {
            text += &format!("; {} by earlier runs", self.earlier);
        }
        text += &self.load;
        text += &self.left_out;
        for (status, pairs) in Status::ALL.iter().zip(&self.found).skip(1) {
            for (name, reason) in pairs.iter().take(LISTED) {
                text += &format!("\n  {} {name}: {}", status.name(), reason.as_deref().unwrap_or("unknown"));
            }
            if pairs.len() > LISTED {
                text += &format!("\n  and {} more {}", pairs.len() - LISTED, status.name());
            }
        }
        text += &format!("\n{} has all\n", hsad::shown(journal));
        // Standard output has the records, where they are printed.
        if self.prints {
            terminal::note(text.trim_end());
            return Ok(());
        }
        terminal::print(&text)
    }

    /// What falls short, and the exit code that says so.
    pub fn shortfall(&self) -> Option<(String, i32)> {
        let [_, doubtful, failed] = self.found.each_ref().map(Vec::len);
        match (failed, doubtful) {
            (0, 0) => None,
            (0, _) => Some((format!("{doubtful} of {} maps are doubtful; their files were written", self.all()), 4)),
            _ => Some((format!("{failed} of {} pairs failed", self.all()), 1)),
        }
    }
}
