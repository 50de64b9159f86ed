//! How busy a run keeps the machine.

use std::{
    num::NonZero,
    thread,
    time::{Duration, Instant},
};

use hsad::Backend;

/// The beginning of a run.
pub struct Load {
    start: Instant,
    processors: Option<Duration>,
    device: Duration,
}

/// Shares of a run's time, 0 to 1.
pub struct Shares {
    /// Of the time of all processors; `None` where the system does not tell.
    pub processors: Option<f64>,
    /// In which some pair waited for the device; `None` without one.
    pub device: Option<f64>,
}

impl Load {
    /// A run on `backend` begins.
    pub fn begin(backend: &Backend) -> Self {
        Self { start: Instant::now(), processors: processor_time(), device: awaited(backend).unwrap_or_default() }
    }

    /// Time since the beginning.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// The shares since the beginning.
    pub fn shares(&self, backend: &Backend) -> Shares {
        let share = |part: Duration, of: f64| part.as_secs_f64() / of.max(1e-9);
        let wall = self.elapsed().as_secs_f64();
        let cores = thread::available_parallelism().map_or(1, NonZero::get) as f64;
        let used = processor_time().zip(self.processors).map(|(now, then)| now.saturating_sub(then));
        Shares {
            processors: used.map(|used| share(used, wall * cores)),
            device: awaited(backend).map(|now| share(now.saturating_sub(self.device), wall)),
        }
    }
}

fn awaited(backend: &Backend) -> Option<Duration> {
    if let Backend::Gpu(gpu) = backend { Some(gpu.awaited()) } else { None }
}

/// Processor time of all threads of the process so far.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes the structure that it is given.
    let result = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    let seconds = u64::try_from(time.tv_sec).ok().filter(|_| result == 0)?;
    Some(Duration::new(seconds, u32::try_from(time.tv_nsec).ok()?))
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_computes_uses_a_processor() {
        let load = Load::begin(&Backend::Cpu);
        let start = processor_time().expect("a time");
        while processor_time().expect("a time") < start + Duration::from_millis(5) {}
        let Shares { processors, device } = load.shares(&Backend::Cpu);
        let used = processors.expect("a share");
        assert!(used > 0.0 && device.is_none(), "{used}");
    }
}
