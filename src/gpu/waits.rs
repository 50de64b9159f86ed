//! How long the host has waited for a device.

use std::sync::{Mutex, PoisonError};

use web_time::{Duration, Instant};

/// Time in which at least one thread waits for results of a device, whose work the results end.
#[derive(Debug, Default)]
pub(super) struct Waits(Mutex<State>);

#[derive(Debug, Default)]
struct State {
    waiting: usize,
    /// When the first of those that wait began.
    since: Option<Instant>,
    ended: Duration,
}

/// A wait, which ends when this is dropped.
pub(super) struct Wait<'a>(&'a Waits);

impl Waits {
    fn with<T>(&self, work: impl FnOnce(&mut State) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn begin(&self) -> Wait<'_> {
        self.with(|state| {
            state.waiting += 1;
            state.since.get_or_insert_with(Instant::now);
        });
        Wait(self)
    }

    /// Time of all waits so far; what several threads wait at once counts once.
    pub fn total(&self) -> Duration {
        self.with(|state| state.ended + state.since.map_or(Duration::ZERO, |since| since.elapsed()))
    }
}

impl Drop for Wait<'_> {
    fn drop(&mut self) {
        self.0.with(|state| {
            state.waiting -= 1;
            if state.waiting == 0 {
                state.ended += state.since.take().map_or(Duration::ZERO, |since| since.elapsed());
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_at_once_count_once() {
        let waits = Waits::default();
        assert_eq!(waits.total(), Duration::ZERO);
        let start = Instant::now();
        let [first, second] = [waits.begin(), waits.begin()];
        while waits.total() < Duration::from_millis(2) {}
        drop(first);
        let total = waits.total();
        while waits.total() < total + Duration::from_millis(1) {}
        drop(second);
        let total = waits.total();
        assert!(total <= start.elapsed(), "{total:?}");
        assert_eq!(waits.total(), total, "nobody waits");
    }
}
