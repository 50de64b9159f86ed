//! Where the records of all pairs come together.

use std::{
    ops::ControlFlow,
    sync::{Mutex, MutexGuard},
    time::Duration,
};

use anyhow::{Error, Result};

use super::{
    journal::Journal,
    load::Shares,
    record::{Finished, Record},
    storage,
    tally::Tally,
};

/// The journal and the tally, shared by the threads of a run, and the error that ends it.
pub struct Desk(Mutex<State>);

struct State {
    /// Not after a record that could not be written, whose line may be there in part.
    journal: Option<Journal>,
    tally: Tally,
    result: Result<()>,
}

impl Desk {
    pub fn new(journal: Journal, tally: Tally) -> Self {
        Self(Mutex::new(State { journal: Some(journal), tally, result: Ok(()) }))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().expect("no panic while it is held")
    }

    /// Counts a pair that an earlier run has finished.
    pub fn count_earlier(&self, name: &str, finished: &Finished) {
        self.state().tally.count_earlier(name, finished);
    }

    /// Records a pair that is done. An error ends the run, and so does a record that cannot be written; pairs that are under way then are
    /// recorded still.
    pub fn record(&self, record: Result<Record>) -> ControlFlow<()> {
        let State { journal, tally, result } = &mut *self.state();
        let written = record.and_then(|record| {
            let Some(mut open) = journal.take() else { return Ok(()) };
            open.add(&record)?;
            *journal = Some(open);
            Ok(tally.count(&record)?)
        });
        if result.is_ok() {
            *result = written.map_err(storage::told);
        }
        if result.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    /// Notes how long the run took, and how busy it kept the machine.
    pub fn note_load(&self, time: Duration, shares: &Shares) {
        self.state().tally.note_load(time, shares);
    }

    /// Ends the run with an error, unless another one has ended it.
    pub fn end(&self, error: Error) {
        let State { result, .. } = &mut *self.state();
        if result.is_ok() {
            *result = Err(error);
        }
    }

    /// Notes which frames are in no pair.
    pub fn note_left_out(&self, text: Option<String>) {
        self.state().tally.note_left_out(text);
    }

    /// The tally of the run, and the error that ended it.
    pub fn close(self) -> (Tally, Result<()>) {
        let State { tally, result, .. } = self.0.into_inner().expect("no panic while it is held");
        (tally, result)
    }
}
