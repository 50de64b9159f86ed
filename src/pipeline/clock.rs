//! The steps of the pipeline as they begin and end.

use web_time::{Duration, Instant};

use super::Step;

/// Tells of each step that begins, and measures it.
pub(super) struct Clock<B> {
    begin: B,
    begun: Option<(Step, Instant)>,
    times: Vec<(Step, Duration)>,
}

impl<B: FnMut(Step)> Clock<B> {
    pub fn new(begin: B) -> Self {
        Self { begin, begun: None, times: Vec::new() }
    }

    /// The step before ends, and `step` begins.
    pub fn enter(&mut self, step: Step) {
        self.end();
        self.begun = Some((step, Instant::now()));
        (self.begin)(step);
    }

    fn end(&mut self) {
        self.times.extend(self.begun.take().map(|(step, start)| (step, start.elapsed())));
    }

    /// The duration of each step; the last one ends.
    pub fn finish(mut self) -> Vec<(Step, Duration)> {
        self.end();
        self.times
    }
}
