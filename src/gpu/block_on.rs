//! Waiting, for callers that block.

/// Runs a future of this library to its end on this thread.
///
/// A future that waits for a device drives the device itself, so any executor will do: this one is for callers without
/// an executor. In a browser nothing can block, and the function does not exist.
pub fn block_on<F: Future>(future: F) -> F::Output {
    pollster::block_on(future)
}
