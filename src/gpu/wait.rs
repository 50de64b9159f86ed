//! Waiting for a device, for callers that block.

use std::{
    pin::pin,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    task::{Context, Poll, Wake, Waker},
    thread::{self, Thread},
};

use crate::error::{Error, Result};

/// Runs `work` to its end on this thread. All that it may wait for is `device`, which is polled meanwhile.
///
/// # Errors
/// Those of `work`; [`Error::DeviceLost`] where the device cannot be polled.
pub(crate) fn wait<T>(device: &wgpu::Device, work: impl Future<Output = Result<T>>) -> Result<T> {
    let mut work = pin!(work);
    let bell = Arc::new(Bell { thread: thread::current(), rung: AtomicBool::new(false) });
    let waker = Waker::from(bell.clone());
    loop {
        if let Poll::Ready(result) = work.as_mut().poll(&mut Context::from_waker(&waker)) {
            return result;
        }
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| Error::DeviceLost(e.to_string()))?;
        // Another thread that polls the device may be the one that delivers, a little later.
        while !bell.rung.swap(false, Ordering::Acquire) {
            thread::park();
        }
    }
}

/// Wakes the thread that waits.
struct Bell {
    thread: Thread,
    rung: AtomicBool,
}

impl Wake for Bell {
    fn wake(self: Arc<Self>) {
        self.rung.store(true, Ordering::Release);
        self.thread.unpark();
    }
}
