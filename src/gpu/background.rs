//! Work on a thread of its own, awaited by any executor.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{Arc, Mutex, PoisonError},
    task::{Poll, Waker},
    thread,
};

/// Work that may be running, and whoever waits for it.
struct Job<W, T> {
    work: Option<W>,
    result: Option<thread::Result<T>>,
    waiting: Option<Waker>,
}

/// Runs `work` on a new thread, or on this thread if none can be created. What the work holds is dropped before the future is ready. The
/// work goes on if the future is dropped.
pub(super) fn in_background<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> impl Future<Output = T> + Send {
    let job = Arc::new(Mutex::new(Job { work: Some(work), result: None, waiting: None }));
    let worker = job.clone();
    let run = move || {
        let locked = || worker.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(work) = locked().work.take() else { return };
        // A panic is handed on to whoever waits.
        let result = catch_unwind(AssertUnwindSafe(work));
        let mut job = locked();
        job.result = Some(result);
        let waiting = job.waiting.take();
        drop(job);
        waiting.into_iter().for_each(Waker::wake);
    };
    if thread::Builder::new().name("hsad".into()).spawn(run.clone()).is_err() {
        run();
    }
    std::future::poll_fn(move |context| {
        let mut job = job.lock().unwrap_or_else(PoisonError::into_inner);
        match job.result.take() {
            Some(result) => Poll::Ready(result.unwrap_or_else(|panic| resume_unwind(panic))),
            None => {
                job.waiting = Some(context.waker().clone());
                Poll::Pending
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::block_on;

    #[test]
    fn the_result_of_another_thread_is_awaited() {
        let here = thread::current().id();
        assert_ne!(block_on(in_background(|| thread::current().id())), here);
    }

    #[test]
    fn what_the_work_holds_is_dropped_before_its_result_is_there() {
        let held = Arc::new(7);
        for _ in 0..100 {
            let work = held.clone();
            assert!(block_on(in_background(move || *work == 7)));
            assert_eq!(Arc::strong_count(&held), 1);
        }
    }

    #[test]
    #[should_panic(expected = "in the background")]
    fn a_panic_reaches_whoever_waits() {
        block_on(in_background(|| panic!("in the background")))
    }
}
