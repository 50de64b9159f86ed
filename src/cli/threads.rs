//! The threads that share the work.

use std::{
    env, io,
    sync::mpsc::{Sender, channel},
    thread,
};

use rayon::{ThreadBuilder, ThreadPoolBuildError, ThreadPoolBuilder};

/// Starts the threads, before there is work to share: as many as the process has cores, or as many fewer as
/// `RAYON_NUM_THREADS` asks for. More would only wait for a core. Where the system does not allow as many, the program's own
/// thread does all the work, and those that are allowed are left to the driver.
///
/// # Errors
/// If the threads were started before.
pub fn start() -> Result<(), ThreadPoolBuildError> {
    let cores = thread::available_parallelism().map_or(1, Into::into);
    match spawned(wanted(env::var("RAYON_NUM_THREADS").ok().as_deref(), cores)) {
        Ok(mut threads) => {
            // The threads run already: where rayon cannot spawn one itself, it leaves no way out.
            let count = threads.len();
            let hand_over = |work| match threads.pop().map(|thread| thread.send(work)) {
                Some(Ok(())) => Ok(()),
                _ => Err(io::ErrorKind::NotFound.into()),
            };
            ThreadPoolBuilder::new().num_threads(count).spawn_handler(hand_over).build_global()
        }
        Err(_) => ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global(),
    }
}

/// The number of threads for a value of the variable; 0 and nonsense stand for all cores, as in rayon.
fn wanted(variable: Option<&str>, cores: usize) -> usize {
    let asked = variable.and_then(|text| text.parse().ok()).filter(|&count| count > 0);
    asked.map_or(cores, |count: usize| count.min(cores))
}

/// `count` threads, each of which waits for work. All of them end if one cannot be spawned.
fn spawned(count: usize) -> io::Result<Vec<Sender<ThreadBuilder>>> {
    let thread = |_| {
        let (sender, work) = channel::<ThreadBuilder>();
        let waiting = move || work.recv().into_iter().for_each(ThreadBuilder::run);
        thread::Builder::new().name("hsad".into()).spawn(waiting)?;
        Ok(sender)
    };
    (0..count).map(thread).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_threads_than_cores() {
        for (variable, expected) in
            [(None, 8), (Some("2000"), 8), (Some("3"), 3), (Some("0"), 8), (Some("-1"), 8), (Some("many"), 8)]
        {
            assert_eq!(wanted(variable, 8), expected, "{variable:?}");
        }
    }

    #[test]
    fn threads_wait_for_their_work_and_end_without() {
        assert_eq!(spawned(3).unwrap().len(), 3);
    }
}
