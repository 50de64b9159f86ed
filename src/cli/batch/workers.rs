//! Several pairs at once.

use std::{ops::ControlFlow, sync::Mutex, thread};

/// Calls `work` with each of `items`, in their order and on `count` threads, until a call breaks: no further one begins then.
pub fn side_by_side<T>(
    items: impl Iterator<Item = T> + Send,
    count: usize,
    work: impl Fn(T) -> ControlFlow<()> + Sync,
) {
    let most = items.size_hint().1.unwrap_or(usize::MAX);
    let items = Mutex::new(Some(items));
    // The lock is held for the next item alone, and not for the work on it.
    let with_items =
        |next: fn(&mut Option<_>) -> Option<T>| next(&mut items.lock().expect("no panic while it is held"));
    let one_after_the_other = || {
        while let Some(item) = with_items(|items| items.as_mut()?.next()) {
            if work(item).is_break() {
                with_items(|items| {
                    *items = None;
                    None
                });
            }
        }
    };
    thread::scope(|scope| {
        // Where the system allows no more threads, this one does all the work.
        for _ in 1..count.min(most) {
            if thread::Builder::new().name("pairs".into()).spawn_scoped(scope, one_after_the_other).is_err() {
                break;
            }
        }
        one_after_the_other();
    });
}

#[cfg(test)]
mod tests {
    use std::{sync::Condvar, time::Duration};

    use super::*;

    #[test]
    fn as_many_as_threads_are_in_work_at_once() {
        let (arrived, all_there) = (Mutex::new(0), Condvar::new());
        let met = Mutex::new(0);
        side_by_side([(); 3].into_iter(), 3, |()| {
            let mut arrived = arrived.lock().unwrap();
            *arrived += 1;
            all_there.notify_all();
            // Each waits for all. Where they come one by one, the first waits in vain.
            let (arrived, waited) =
                all_there.wait_timeout_while(arrived, Duration::from_secs(60), |arrived| *arrived < 3).unwrap();
            drop(arrived);
            *met.lock().unwrap() += u32::from(!waited.timed_out());
            if waited.timed_out() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(met.into_inner().unwrap(), 3);
    }

    #[test]
    fn every_item_is_worked_on_once_until_one_breaks() {
        let seen = Mutex::new(Vec::new());
        let items: Vec<u32> = (0..50).collect();
        let note = |item: u32| {
            seen.lock().unwrap().push(item);
            if item == 40 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        side_by_side(0..30, 4, note);
        let mut all = std::mem::take(&mut *seen.lock().unwrap());
        all.sort_unstable();
        assert_eq!(all, items[..30]);
        side_by_side(0..50, 1, note);
        assert_eq!(*seen.lock().unwrap(), items[..=40]);
        side_by_side(0..0, 4, note);
    }
}
