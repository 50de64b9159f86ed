//! Several threads for one work.

use std::thread;

/// Calls `work` on `count` threads at once, this one among them, and returns when all calls have.
pub fn side_by_side(count: usize, work: impl Fn() + Sync) {
    thread::scope(|scope| {
        // Where the system allows no more threads, this one does all the work.
        for _ in 1..count {
            if thread::Builder::new().name("pairs".into()).spawn_scoped(scope, &work).is_err() {
                break;
            }
        }
        work();
    });
}

#[cfg(test)]
mod tests {
    use std::{
        sync::{Condvar, Mutex},
        time::Duration,
    };

    use super::*;

    #[test]
    fn as_many_as_threads_are_in_work_at_once() {
        let (arrived, all_there) = (Mutex::new(0), Condvar::new());
        let met = Mutex::new(0);
        side_by_side(3, || {
            let mut arrived = arrived.lock().unwrap();
            *arrived += 1;
            all_there.notify_all();
            // Each waits for all. Where they come one by one, the first waits in vain.
            let (arrived, waited) =
                all_there.wait_timeout_while(arrived, Duration::from_secs(60), |arrived| *arrived < 3).unwrap();
            drop(arrived);
            *met.lock().unwrap() += u32::from(!waited.timed_out());
        });
        assert_eq!(met.into_inner().unwrap(), 3);
    }
}
